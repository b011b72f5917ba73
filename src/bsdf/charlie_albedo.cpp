#include "bsdf/charlie_albedo.h"

#include "bsdf/models/microfacet_sheen.h"
#include "core/parallel.h"
#include "core/quadrature.h"

namespace nacre {

CharlieAlbedo::CharlieAlbedo() : table_(std::size_t(n_cos) * n_roughness) {
  const std::vector<DirectionNode> nodes = hemisphere_rule(40, 24);
  parallel_for(table_.size(), [&](std::size_t cell) {
    const double c = std::max(1e-4, sqr(double(cell % n_cos) / (n_cos - 1)));
    auto sheen = default_model<Charlie<double, 1>>();
    sheen.roughness = roughness_lo + (1 - roughness_lo) * sqr(double(cell / n_cos) / (n_roughness - 1));
    sheen.softened = 0;
    const Vec3d wo{std::sqrt(1 - c * c), 0, c};
    double sum = 0;
    for (const DirectionNode& n : nodes)
      sum += n.weight * n.w.z * sheen.eval(wo, n.w)[0];
    table_[cell] = float(sum);
  });
}

const CharlieAlbedo& CharlieAlbedo::table() {
  static const CharlieAlbedo instance;
  return instance;
}

} // namespace nacre
