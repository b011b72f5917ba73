#pragma once
// Measured scattering on a separable grid of angles: what goniophotometers and most lighting software store.
//
// Incidence is (theta_i, phi_i) about the normal. Scattering is (theta_o, phi_o) about an axis that turns
// with the incidence: the normal, where phi_o is the azimuth of wo minus that of wi (0: back to the light),
// or the specular direction, where phi_o = 0 points from there towards the normal and increases
// counter-clockwise. Either way a highlight stays at the same theta_o, phi_o between neighbouring azimuths of
// incidence, and about the specular direction between angles of incidence too, so that interpolation does not
// smear it. A transmission grid has wo behind the surface, mirrored to the front for its angles.
//
// Interpolation is linear in each of the four angles, periodic in the azimuths. Holes take no part: the
// weights of the other corners are scaled to sum to 1. So do nodes about the specular direction that would
// lie below the horizon. A node at theta_o = 0 is one direction whatever its azimuth: it holds the mean over
// the azimuths, and so does theta_i = 0 of an isotropic grid.

#include "measured/measured_bsdf.h"

#include <array>
#include <optional>

namespace nacre {

class AngleGrid final : public MeasuredBsdf {
public:
  enum class Axis { normal, specular };
  enum class Mirror {
    none,
    plane_of_incidence, ///< f(phi_o) = f(-phi_o)
    sample,             ///< f(phi_i, phi_o) = f(-phi_i, -phi_o)
  };
  /// Nodes in radians, increasing; one node of phi_i is an isotropic grid, one of phi_o a value for all
  /// azimuths. With a mirror phi_o lies in [0, pi]; else the azimuths span at most a turn, and a last node
  /// that is a turn from the first is merged with it (their mean). Between the last node and the first, a
  /// turn on, there is a hole where that gap is more than twice the largest between other nodes.
  struct Nodes {
    std::vector<double> theta_i{}, phi_i{}, theta_o{}, phi_o{};
    Axis axis = Axis::normal;
    Mirror mirror = Mirror::none;
    bool transmits = false;
    /// Polar angle of the specular direction at each theta_i; empty: theta_i itself. It is that of the
    /// refracted ray where a transmission grid is centred there.
    std::vector<double> theta_specular{};
    /// The value of the first and the last node of theta holds from 0 and up to the horizon; else beyond them
    /// is a hole.
    bool holds_beyond_ends = false;
  };

  /// A grid may have at most this many nodes.
  static constexpr std::size_t max_nodes = std::size_t(1) << 26;

  /// @param values  1/sr, NaN in holes, channel fastest, then phi_o, theta_o, phi_i, theta_i; a node with a
  /// hole
  ///                in one channel is a hole in all
  /// @throws Error where sizes or angles do not fit or a value is infinite
  AngleGrid(Nodes nodes, Channels channels, std::vector<float> values, std::string kind,
            std::vector<std::pair<std::string, std::string>> facts = {});

  std::string kind() const override { return kind_; }
  std::vector<std::pair<std::string, std::string>> facts() const override;
  const Channels& channels() const override { return channels_; }
  bool is_isotropic() const override { return nodes_.phi_i.size() == 1; }
  MeasuredSides sides() const override;
  bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const override;
  /// Directions in the surface are left out, and so are repetitions of theta_o = 0 over the azimuths.
  MeasuredSamples samples() const override;

  const Nodes& nodes() const { return nodes_; }
  std::size_t hole_count() const;
  /// The values at a node, NaN in a hole.
  std::span<const float> at(std::size_t i_theta_i, std::size_t i_phi_i, std::size_t i_theta_o,
                            std::size_t i_phi_o) const;
  /// The directions of a node; wo may lie on the other side of the horizon.
  std::pair<Vec3d, Vec3d> directions(std::size_t i_theta_i, std::size_t i_phi_i, double theta_o,
                                     double phi_o) const;
  /// Share of the light that arrives from a node of incidence and is scattered to where the grid has values,
  /// per channel: the midpoint rule with 8 x 8 points in each cell between nodes of theta_o and phi_o.
  std::vector<double> albedo(std::size_t i_theta_i, std::size_t i_phi_i) const;
  /// Multiplies all values of a channel at a node of incidence.
  void scale(std::size_t i_theta_i, std::size_t i_phi_i, std::size_t channel, double factor);
  /// Turns f |cos theta_o| into f; nodes in the surface become holes.
  void divide_by_cosines();

private:
  /// Two nodes about an angle and the weight of the second.
  struct Between {
    std::size_t below = 0, above = 0;
    double t = 0;
  };
  std::optional<Between> between_thetas(const std::vector<double>& nodes, double angle) const;
  std::optional<Between> between_azimuths(const std::vector<double>& nodes, double angle,
                                          bool mirrored) const;
  std::array<double, 4> angles(const Vec3d& wo, const Vec3d& wi) const;
  double specular(double theta_i) const;
  std::size_t index(std::size_t i, std::size_t j, std::size_t k, std::size_t l) const;
  std::size_t node_count() const;
  void check() const;
  void merge_full_turns();
  void remove_partial_and_hidden_nodes();
  void average_poles();
  void average_ring(std::size_t i, std::size_t j, std::size_t k);

  Nodes nodes_;
  Channels channels_;
  std::vector<float> values_;
  std::string kind_;
  std::vector<std::pair<std::string, std::string>> facts_;
};

} // namespace nacre
