#include "fit/channel_lobe.h"

namespace nacre {
namespace {

/// Derivatives that a shader carries at once.
constexpr std::size_t carried_at_once = 4;
using DualPack = Dual<Pack, int(carried_at_once)>;

template <class R>
Vec3<R> direction(const std::array<const float*, 3>& w, std::size_t i) {
  return {R(load(w[0] + i)), R(load(w[1] + i)), R(load(w[2] + i))};
}

} // namespace

ChannelLobe::ChannelLobe(const LobeSpec& lobe, int channel) : user_(lobe.user), channel_(channel) {
  if (!user_) listed_ = &model_derivatives(lobe.model);
  const ModelInfo& model = model_info(lobe);
  for (std::size_t p = 0; p < lobe.values.size(); ++p) {
    const bool all = user_ && model.parameters[p].per_channel;
    for (int c = all ? 0 : channel; c <= (all ? 2 : channel); ++c) {
      numbers_.push_back({int(p), c});
      values_.push_back(lobe.values[p][std::size_t(c)]);
    }
  }
}

void ChannelLobe::evaluate(std::span<const double> values, std::span<const int> which,
                           const DirectionArrays& at, std::size_t n, float* f, float* df) const {
  if (listed_)
    listed_->evaluate(values, which, at, n, f, df);
  else
    evaluate_shader(values, which, at, n, f, df);
}

void ChannelLobe::evaluate_shader(std::span<const double> values, std::span<const int> which,
                                  const DirectionArrays& at, std::size_t n, float* f, float* df) const {
  if (!df || which.empty()) {
    std::vector<Pack> packs;
    for (const double x : values)
      packs.push_back(constant<Pack>(x));
    for (std::size_t i = 0; i < n; i += pack_width)
      store(f + i, user_->eval<Pack>(packs, direction<Pack>(at.wo, i), direction<Pack>(at.wi, i))[channel_]);
    return;
  }
  for (std::size_t first = 0; first < which.size(); first += carried_at_once) {
    const auto carried = which.subspan(first, std::min(which.size() - first, carried_at_once));
    std::vector<DualPack> numbers;
    for (const double x : values)
      numbers.push_back(DualPack(constant<Pack>(x)));
    for (std::size_t k = 0; k < carried.size(); ++k)
      numbers[std::size_t(carried[k])].d[k] = Pack(1.0f);
    for (std::size_t i = 0; i < n; i += pack_width) {
      const DualPack y = user_->eval<DualPack>(numbers, direction<DualPack>(at.wo, i),
                                               direction<DualPack>(at.wi, i))[channel_];
      store(f + i, y.v);
      for (std::size_t k = 0; k < carried.size(); ++k)
        store(df + (first + k) * n + i, y.d[k]);
    }
  }
}

} // namespace nacre
