#pragma once
// The target that a fuzzer calls with bytes: one of the measured formats, or the reader of users' .brdf
// files, reads them.

#include "measured/formats.h"

#include <cstddef>
#include <cstdint>

namespace nacre {

/// The measured formats, and .brdf files as "brdf".
const std::vector<MeasuredFormat>& fuzzed_formats();

/// The format that LLVMFuzzerTestOneInput reads from now on.
void select_format(const MeasuredFormat& format);

/// What became of the inputs so far.
struct FuzzCounts {
  std::size_t read = 0, refused = 0;
};
const FuzzCounts& fuzz_counts();

} // namespace nacre

/// Returns 0, whether the input is read or refused. Anything but an Error that names the input (another
/// exception, a signal, a value that is not finite unless a .brdf file has it so, samples that do not fit
/// together) is a fault and leaves as an exception or a signal.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
