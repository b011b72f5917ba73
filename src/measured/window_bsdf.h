#pragma once
// Scattering of glazing and of any surface as LBNL's WINDOW and Radiance exchange it: blocks of light that
// arrives on one side and leaves on one, each constant in patches of both directions. Source of the
// conventions: Radiance's bsdf library (bsdf_m.c, bsdf_t.c).
//
// Values are f in 1/sr, without the cosine. Nothing is interpolated: f is the value of the patch. What WINDOW
// calls the front (the outside of a window) is the back of Radiance, whose normal points into the room: z > 0
// is the room's side here too, so "Reflection Back" is what the front reflects. x and y are those of the file
// on both sides. Light that arrives from wi travels along -wi: incident patches are counted by -wi's x and y,
// outgoing ones by wo's. Light through the sample that only one block of the two holds comes from the other
// by exchanging wo and wi, as in Radiance.
//
// Of coloured data, X, Y and Z are those of the sample relative to a perfect diffuser, so that X = Y = Z is
// neutral; f is linear sRGB, from these times the white D65, and may be negative outside the gamut.

#include "measured/klems_basis.h"
#include "measured/measured_bsdf.h"
#include "measured/tensor_tree.h"

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace nacre {

/// f by patches: rows are outgoing, columns incident.
struct KlemsMatrix {
  std::shared_ptr<const KlemsBasis> incident, outgoing;
  std::vector<float> values; ///< [outgoing][incident]
  float at(int in, int out) const {
    return values[std::size_t(out) * std::size_t(incident->size()) + std::size_t(in)];
  }
};

/// What one block holds of one component.
using WindowData = std::variant<KlemsMatrix, TensorTree>;

/// Light that arrives on a side and stays there or passes. Sides by WINDOW's names.
enum class WindowDirection { transmission_front, transmission_back, reflection_front, reflection_back };
inline constexpr std::array<const char*, 4> window_direction_names{"Transmission Front", "Transmission Back",
                                                                   "Reflection Front", "Reflection Back"};

enum class WindowColor { grey, xyz, yuv }; ///< Y; X, Y, Z; Y, u', v' of CIE 1976

/// The components of one block in the order of WindowColor's comment, all in the same bases.
using WindowBlock = std::vector<WindowData>;

class WindowBsdf final : public MeasuredBsdf {
public:
  using Blocks = std::array<std::optional<WindowBlock>, 4>; ///< by WindowDirection
  using Facts = std::vector<std::pair<std::string, std::string>>;

  /// @throws Error unless there is a block, each has all components, and all are trees or all matrices
  WindowBsdf(WindowColor color, Blocks blocks, Facts facts);
  WindowBsdf(WindowBsdf&&) noexcept;
  WindowBsdf& operator=(WindowBsdf&&) noexcept;
  ~WindowBsdf() override;

  std::string kind() const override;
  std::vector<std::pair<std::string, std::string>> facts() const override;
  const Channels& channels() const override { return channels_; }
  bool is_isotropic() const override { return isotropic_; }
  MeasuredSides sides() const override;
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override;
  /// f at the middle of patches. Of a tree, cells larger than 1/8 are cut and the smallest joined, so that
  /// there are some 2^20 at most.
  MeasuredSamples samples() const override;
  /// Of matrices: in proportion to f cos theta_i, exactly, of the components' sum.
  double pdf(const Vec3d& wo, const Vec3d& wi) const override;
  Vec3d sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const override;

  WindowColor color() const { return color_; }
  const Blocks& blocks() const { return blocks_; }

private:
  class MatrixSampling;
  struct LazyMatrixSampling;
  /// The block for a pair of directions and the pair as it looks it up; none: not measured.
  struct Lookup {
    const WindowBlock* block = nullptr;
    Vec3d in, out; ///< z > 0: x and y as the block counts them
    bool exchanged = false;
  };
  Lookup lookup(const Vec3d& wo, const Vec3d& wi) const;
  void to_channels(std::array<float, 3> stored, float* f) const;
  void append_samples(MeasuredSamples& s, WindowDirection direction, const WindowBlock& block) const;
  const MatrixSampling& matrix_sampling() const;

  WindowColor color_;
  Blocks blocks_;
  Facts facts_;
  Channels channels_;
  bool isotropic_ = false, matrices_ = false;
  std::unique_ptr<LazyMatrixSampling> sampling_;
};

/// Where a tree of the rank is looked up. @param in, out as the blocks count them, z >= 0
TensorTree::Position tensor_position(int rank, const Vec3d& in, const Vec3d& out);
/// The directions of a position; of rank 3, those with `in` on azimuth 0. @return in and out, z >= 0
std::pair<Vec3d, Vec3d> tensor_directions(int rank, const TensorTree::Position& position);

/// wo and wi of a block's pair of directions, and back: both signs of z, -x and -y of the incident.
std::pair<Vec3d, Vec3d> window_directions(WindowDirection direction, const Vec3d& in, const Vec3d& out);

} // namespace nacre
