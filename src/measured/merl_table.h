#pragma once
// Tabulated isotropic reflectance in the MERL format: RGB over half and difference angles.
// Source: Matusik et al. 2003, A Data-Driven Reflectance Model.
//
// Convention. The format's lookup rounds down: entry i is used for sqrt(theta_h / (pi/2)) n_theta_h in [i,
// i+1), likewise for theta_d and phi_d. Here an entry is the value *at the lower edge* of that interval, its
// node, and the table is linear between nodes in (sqrt(theta_h), theta_d, phi_d). Reading, tabulating and
// fitting all use these nodes. Past the last node in theta_h or theta_d (88.0 and 89 degrees of the original)
// the last value holds; phi_d is periodic.

#include "core/spectrum.h"
#include "measured/measured_bsdf.h"
#include "measured/rusinkiewicz.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace nacre {

/// An immutable table. Entries that were not measured (negative in the file, as below the horizon) are
/// holes: they have no value and take no part in interpolation.
class MerlTable final : public MeasuredBsdf {
public:
  /// Red, green, blue in 1/sr, linear, without cosine; then 1, or all four 0 for a hole.
  using Cell = std::array<float, 4>;
  /// RGB in 1/sr at (theta_h, theta_d, phi_d); any negative channel makes a hole. Called from many threads.
  using Function = std::function<std::array<double, 3>(double, double, double)>;

  static constexpr int original_theta_h = 90, original_theta_d = 90, original_phi_d = 180;

  /// Cells in the order of the file, phi_d fastest. @param filled  which of them were not measured but filled
  /// in (measured/hole_filling.h), or empty. @throws Error for sizes that are no table
  MerlTable(int n_theta_h, int n_theta_d, int n_phi_d, std::vector<Cell> cells,
            std::vector<bool> filled = {});
  /// The table of `f` at the nodes. @throws Error for sizes that are no table, or where f is not finite
  static MerlTable tabulate(int n_theta_h, int n_theta_d, int n_phi_d, const Function& f);
  MerlTable(MerlTable&&) noexcept;
  MerlTable& operator=(MerlTable&&) noexcept;
  ~MerlTable() override;

  std::string kind() const override;
  std::vector<std::pair<std::string, std::string>> facts() const override;
  const Channels& channels() const override;
  bool is_isotropic() const override { return true; }
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override;
  MeasuredSamples samples() const override;

  int n_theta_h() const { return n_theta_h_; }
  int n_theta_d() const { return n_theta_d_; }
  int n_phi_d() const { return n_phi_d_; }
  std::size_t size() const { return cells_.size(); }
  std::size_t hole_count() const { return holes_; }
  /// Entries that have a value though none was measured. A file does not keep which they are.
  std::size_t filled_count() const { return filled_count_; }

  /// Angles of nodes, in radians.
  double theta_h(int i) const { return pi / 2 * sqr(i / double(n_theta_h_)); }
  double theta_d(int j) const { return pi / 2 * j / n_theta_d_; }
  double phi_d(int k) const { return phi_d_period() * k / n_phi_d_; }
  HalfDifference<double> node(int i, int j, int k) const { return {theta_h(i), theta_d(j), phi_d(k)}; }
  /// pi: the file holds half the circle and reciprocity gives the rest. 2 pi for tables 360 wide, which hold
  /// both halves as they were measured.
  double phi_d_period() const { return n_phi_d_ == 2 * original_phi_d ? 2 * pi : pi; }

  const Cell& cell(int i, int j, int k) const {
    return cells_[(static_cast<std::size_t>(i) * n_theta_d_ + j) * n_phi_d_ + k];
  }
  std::span<const Cell> cells() const { return cells_; }
  bool is_hole(int i, int j, int k) const { return cell(i, j, k)[3] == 0; }
  bool is_filled(int i, int j, int k) const {
    return !filled_.empty() && filled_[(static_cast<std::size_t>(i) * n_theta_d_ + j) * n_phi_d_ + k];
  }
  /// The part of the pairs of directions that lies nearest to a node when only every `step`-th of each angle
  /// is kept; not normalised. dwo dwi = 4 cos theta_d dwh dwd, so it is |d cos theta_h| d(sin^2 theta_d) over
  /// the cell between the midpoints to the neighbours.
  double node_weight(int i, int j, int theta_h_step = 1, int theta_d_step = 1) const;

  /// RGB at any angles, R = float, double or Pack: trilinear between nodes. Holes take no part: the weights
  /// of the remaining corners are scaled to sum to 1; 0 where all eight are holes.
  template <class R>
  Spectrum<R, 3> interpolate(const HalfDifference<R>& a) const;

private:
  /// The cell at the lower corner, and the fractions of the way to the upper one.
  template <class T>
  struct Corner {
    T i, j, k, fi, fj, fk;
  };
  template <class R>
  Corner<R> corner(const HalfDifference<R>& a) const;
  template <class T>
  std::array<T, 4> blend(const Corner<T>& c) const;

  int n_theta_h_, n_theta_d_, n_phi_d_;
  std::size_t holes_ = 0, filled_count_ = 0;
  std::vector<Cell> cells_;
  std::vector<bool> filled_; ///< empty: none
};

/// Any measurement as a table of the original's size: its RGB at the nodes, of an anisotropic one the mean
/// over 16 azimuths; a hole where nothing was measured.
/// @throws Error if it does not reflect on the front
MerlTable tabulate_merl(const MeasuredBsdf& measured);

/// Reads a `.binary` file. @throws Error with the byte offset for anything but a whole table of finite values
std::shared_ptr<const MerlTable> read_merl(const std::string& path);
/// The same from the bytes of a file; `name` is for messages.
MerlTable parse_merl(std::span<const std::uint8_t> bytes, std::string_view name);

/// Writes a `.binary` file, holes as -1; read_merl gives the identical table back. @throws Error
void write_merl(const MerlTable& table, const std::string& path);
/// The bytes of that file.
std::vector<std::uint8_t> encode_merl(const MerlTable& table);

} // namespace nacre

#include "measured/merl_interpolation.h"
