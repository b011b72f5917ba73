#pragma once
// A lobe as a fit sees it: f in one channel, and its exact derivatives by the numbers that it depends on
// there. A listed model never mixes channels; a user's shader may.

#include "bsdf/model_functions.h"
#include "measured/material_spec.h"

namespace nacre {

class ChannelLobe {
public:
  /// One number of the lobe's parameters.
  struct Number {
    int parameter, channel; ///< channel: which of a colour's numbers
  };

  /// @param lobe  no table
  ChannelLobe(const LobeSpec& lobe, int channel);

  /// What f may depend on in this channel, in declared order: of a listed model the channel's own numbers, of
  /// a user's all.
  const std::vector<Number>& numbers() const { return numbers_; }
  const std::vector<double>& values() const { return values_; }

  /// f at `n` directions, a multiple of pack_width, and its derivatives: that by number which[k] in direction
  /// i at df[k n + i]. `df` may be null.
  /// @param values  one a number
  /// @param which   places in numbers(), ascending
  void evaluate(std::span<const double> values, std::span<const int> which, const DirectionArrays& at,
                std::size_t n, float* f, float* df) const;

private:
  void evaluate_shader(std::span<const double> values, std::span<const int> which, const DirectionArrays& at,
                       std::size_t n, float* f, float* df) const;

  const ModelDerivatives* listed_ = nullptr; ///< null: `user_`
  std::shared_ptr<const UserModel> user_;
  int channel_;
  std::vector<Number> numbers_;
  std::vector<double> values_;
};

} // namespace nacre
