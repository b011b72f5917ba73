#include "fit/robust_loss.h"

#include "core/error.h"

#include <fmt/format.h>
#include <string>
#include <vector>

namespace nacre {
namespace {
const std::vector<std::string> names{"squares", "huber", "soft_l1", "cauchy"};
}

std::string_view loss_name(LossKind kind) { return names[std::size_t(kind)]; }

LossKind parse_loss(std::string_view name) {
  for (std::size_t i = 0; i < names.size(); ++i)
    if (names[i] == name) return LossKind(i);
  throw Error(fmt::format("unknown loss '{}'{}", name, suggestion(name, names)));
}

} // namespace nacre
