#pragma once
// Isotropic reflectance as a small neural network. Source: Sztrajman, Rainer, Ritschel and Weyrich 2021,
// Neural BRDF Representation and Importance Sampling, section 3.
//
// Input are the half and difference vectors in Rusinkiewicz's frame, (sin theta_h, 0, cos theta_h, sin
// theta_d cos phi_d, sin theta_d sin phi_d, cos theta_d); layers are dense, all but the last followed by
// max(x, 0); f = max(exp(y) - 1, 0) in 1/sr, linear sRGB, without the cosine. phi_d is that of the MERL
// tables the networks were trained on, in [0, pi): reciprocity gives the other half of the circle, as it does
// there. Nothing is interpolated: f is the network's own value everywhere above the surface.

#include "measured/measured_bsdf.h"

#include <cstddef>
#include <string>
#include <vector>

namespace nacre {

class NeuralBrdf final : public MeasuredBsdf {
public:
  static constexpr std::size_t inputs = 6, outputs = 3, max_width = 256, max_layers = 16;

  /// y = x kernel + bias; kernel is [inputs][outputs], the last index fastest.
  struct Layer {
    std::size_t inputs = 0, outputs = 0;
    std::vector<float> kernel, bias;
  };
  /// @throws Error unless the layers fit each other, 6 inputs and 3 outputs, and all numbers are finite
  explicit NeuralBrdf(const std::vector<Layer>& layers);

  std::string kind() const override { return "isotropic neural reflectance (NBRDF)"; }
  std::vector<std::pair<std::string, std::string>> facts() const override;
  const Channels& channels() const override;
  bool is_isotropic() const override { return true; }
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override;
  /// f at the nodes of the MERL grid, every 2nd in theta_h, every 3rd in theta_d and every 6th in phi_d.
  MeasuredSamples samples() const override;

  /// RGB in 1/sr at any angles.
  std::array<float, 3> value(double theta_h, double theta_d, double phi_d) const;
  const std::vector<Layer>& layers() const { return layers_; }

private:
  std::vector<Layer> layers_;
  std::vector<std::vector<float>> rows_; ///< of each layer: bias, then kernel, rows padded to whole packs
};

} // namespace nacre
