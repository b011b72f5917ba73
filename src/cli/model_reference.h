#pragma once
// The reference page of the models, from what they declare.

#include "bsdf/list.h"

#include <string>

namespace nacre {

/// A page in Markdown: each model with its picture, curve, source, laws and parameters. The pictures are
/// expected beside it as pictures/models/NAME.png and NAME.svg.
std::string model_reference(const std::vector<ModelInfo>& models);

} // namespace nacre
