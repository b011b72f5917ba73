#include "measured_target.h"

#include "core/error.h"
#include "core/random.h"
#include "core/vec.h"
#include "measured/user_bsdf.h"

#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <iostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {
namespace {

constexpr std::string_view input_name = "input";

const MeasuredFormat* selected = nullptr;
FuzzCounts counts;

void require(bool holds, const char* what) {
  if (!holds) throw std::logic_error(what);
}

/// Asks of a measurement all that its users ask.
void use(const MeasuredBsdf& measured, bool sample_too) {
  require(!measured.kind().empty(), "the measurement has no kind");
  measured.facts();
  const bool may_fail = dynamic_cast<const UserBsdf*>(&measured) != nullptr; // a formula says 0/0 if it likes
  const Channels& channels = measured.channels();
  const std::size_t n = std::size_t(channels.count());
  std::vector<float> f(n);
  for (int i = 0; i < 24; ++i) {
    const auto u = [i](int d) { return unit_double(hash(31, i, d)); };
    const double theta = i == 0 ? 0 : pi * u(0);
    const Vec3d wo = spherical_direction(theta, 2 * pi * u(1));
    const Vec3d wi = i % 3 == 0 ? Vec3d{-wo.x, -wo.y, wo.z} : spherical_direction(pi * u(2), 2 * pi * u(3));
    const bool known = measured.evaluate(wo, wi, f);
    for (const float x : f) {
      require(may_fail || std::isfinite(x), "a value is not finite");
      require(known || x == 0, "a hole has a value");
    }
    for (const double x : measured.rgb(wo, wi))
      require(may_fail || (std::isfinite(x) && x >= 0), "a colour is negative or not finite");
    if (!sample_too) continue;
    const Vec3d w = measured.sample(wo, u(4), Vec2d{u(5), u(6)});
    const double pdf = measured.pdf(wo, w);
    require(!(pdf < 0) && !std::isnan(pdf), "a density is negative or no number");
    require(!(pdf > 0) || std::abs(length(w) - 1) < 1e-3, "a sampled direction is not of unit length");
  }
  const MeasuredSamples samples = measured.samples();
  require(samples.wi.size() == samples.size() && samples.weight.size() == samples.size() &&
              samples.f.size() == n * samples.size(),
          "the samples do not fit together");
  for (const float x : samples.f)
    require(std::isfinite(x), "a sample is not finite");
}

} // namespace

const std::vector<MeasuredFormat>& fuzzed_formats() {
  static const std::vector<MeasuredFormat> formats = [] {
    std::vector<MeasuredFormat> all = measured_formats();
    all.push_back({"brdf",
                   "a parameter block and a GLSL function (Disney)",
                   {".brdf"},
                   nullptr,
                   [](std::span<const std::uint8_t> bytes, std::string_view name) {
                     const auto model =
                         UserModel::parse({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, name);
                     return std::shared_ptr<const MeasuredBsdf>(
                         std::make_shared<const UserBsdf>(model, model->initial_values()));
                   },
                   nullptr});
    return all;
  }();
  return formats;
}

void select_format(const MeasuredFormat& format) {
  selected = &format;
  counts = {};
}

const FuzzCounts& fuzz_counts() { return counts; }

} // namespace nacre

/// For libFuzzer, which leaves options that begin with two dashes alone: --format=NAME.
extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  using namespace nacre;
  constexpr std::string_view option = "--format=";
  std::string_view wanted;
  for (int i = 1; i < *argc; ++i)
    if (const std::string_view word = (*argv)[i]; word.starts_with(option))
      wanted = word.substr(option.size());
  std::vector<std::string> names;
  for (const MeasuredFormat& format : fuzzed_formats()) {
    if (!format.parse) continue;
    names.emplace_back(format.name);
    if (format.name == wanted) select_format(format);
  }
  if (!selected) {
    std::cerr << fmt::format("expected --format=NAME, found '{}'{}\n", wanted, suggestion(wanted, names));
    std::exit(2);
  }
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace nacre;
  try {
    const std::span<const std::uint8_t> bytes(data, size);
    if (selected->recognises) selected->recognises(bytes);
    const auto measured = selected->parse(bytes, input_name);
    require(measured != nullptr, "the reader returned nothing");
    // A table of densities takes a tenth of a second and more: only now and then, by the bytes alone.
    std::uint64_t state = size;
    for (std::size_t i = 0; i < size; i += 1 + size / 64)
      state = hash_step(state, data[i]);
    const auto* user = dynamic_cast<const UserBsdf*>(measured.get());
    use(*measured, state % 128 == 0 && (!user || user->operations() < 500));
    ++counts.read;
  } catch (const Error& e) {
    if (!std::string_view(e.what()).starts_with(input_name))
      throw std::logic_error(fmt::format("an error does not name its file: {}", e.what()));
    ++counts.refused;
  }
  return 0;
}
