#pragma once
// Measured scattering, whatever file it came from. A reader gives one of these; evaluation, plots,
// validation, fits, rendering and conversion ask nothing else.
//
// Directions are those of bsdf/model.h: unit, local frame, away from the surface, wo to the viewer, wi to the
// light; z > 0 is the side that a reflection sample faces. Values are f in 1/sr without the cosine.

#include "core/vec.h"
#include "measured/channels.h"
#include "measured/measured_source.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace nacre {

class DirectionSampling;

/// The values of a measurement where they were measured, as a structure of arrays.
struct MeasuredSamples {
  std::vector<Vec3f> wo, wi;
  std::vector<float> f;       ///< sample after sample, a number a channel
  std::vector<double> weight; ///< share of the pairs of directions (dwo dwi) a sample stands for, not
                              ///< normalised; 1 each where samples lie scattered
  std::size_t size() const { return wo.size(); }
};

/// Which pairs of sides a measurement knows; front is z > 0.
struct MeasuredSides {
  bool reflects_front = true, reflects_back = false; ///< wo and wi both in front, both behind
  bool transmits_to_front = false;                   ///< wo in front, wi behind
  bool transmits_to_back = false;                    ///< wo behind, wi in front

  bool transmits() const { return transmits_to_front || transmits_to_back; }
  /// False where one of the directions lies in the surface.
  bool contain(const Vec3d& wo, const Vec3d& wi) const;
};

/// Immutable; all functions may be called from many threads.
class MeasuredBsdf {
public:
  virtual ~MeasuredBsdf();

  /// "isotropic reflectance table (MERL)"
  virtual std::string kind() const = 0;
  /// What a person wants to know beyond the kind, as label and text: resolution, instrument, remarks.
  virtual std::vector<std::pair<std::string, std::string>> facts() const = 0;
  virtual const Channels& channels() const = 0;
  virtual bool is_isotropic() const = 0;
  virtual MeasuredSides sides() const { return {}; }

  /// f of every channel by the interpolation that the format states. @param f channels().count() numbers
  /// @return false in a hole or on a side that was not measured: then f is all 0
  virtual bool evaluate(const Vec3d& wo, const Vec3d& wi, std::span<float> f) const = 0;
  /// What was measured, holes left out, in the format's own order.
  virtual MeasuredSamples samples() const = 0;

  /// f in linear sRGB, no channel below 0.
  virtual std::array<double, 3> rgb(const Vec3d& wo, const Vec3d& wi) const;
  /// f at the wavelengths of a path, none below 0.
  virtual SampledSpectrum at(const Vec3d& wo, const Vec3d& wi, const Wavelengths& wavelengths) const;

  /// Density per solid angle of what `sample` gives, 1/sr.
  virtual double pdf(const Vec3d& wo, const Vec3d& wi) const;
  /// A direction for uniform numbers in [0, 1), roughly in proportion to luminance times cosine. Formats with
  /// a sampling of their own override both; else a table of densities is made at the first call.
  virtual Vec3d sample(const Vec3d& wo, double u_lobe, const Vec2d& u) const;
  /// That table of densities; thread-safe.
  const DirectionSampling& sampling() const;

  /// The file this was read from; null: made in memory.
  const std::shared_ptr<const MeasuredSource>& source() const { return source_; }
  /// For read_measured, before anyone else has the measurement.
  void came_from(MeasuredSource source) const;

protected:
  MeasuredBsdf();
  MeasuredBsdf(MeasuredBsdf&&) noexcept;
  MeasuredBsdf& operator=(MeasuredBsdf&&) noexcept;

private:
  struct LazySampling;
  std::unique_ptr<LazySampling> sampling_;
  mutable std::shared_ptr<const MeasuredSource> source_;
};

/// Reads any measurement, by its ending and its first bytes. The formats: docs/measured.md.
/// @throws Error with the place in the file, or naming the known endings
std::shared_ptr<const MeasuredBsdf> read_measured(const std::string& path);
/// True where the ending is one of a measurement.
bool is_measured_file(const std::string& path);

} // namespace nacre
