#pragma once
// Rows of the tables of values that other programs computed.

#include "core/vec.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

namespace nacre::reference_table {

struct Row {
  std::string set; ///< first column: file or parameters
  double theta_i, theta_o, phi;
  std::array<double, 3> f;
  Vec3d wo, wi;
  std::string text() const {
    std::ostringstream s;
    s << set << " theta_i " << theta_i << " theta_o " << theta_o << " phi " << phi;
    return s.str();
  }
};

/// Rows of reference/`file` whose first column begins with `set`; empty where the data is absent.
inline std::vector<Row> read(const std::string& file, const std::string& set) {
  std::vector<Row> rows;
  std::ifstream in(std::string(NACRE_SOURCE_DIR) + "/../shared/data/reference/" + file);
  for (std::string line; std::getline(in, line);) {
    if (line.compare(0, set.size(), set) != 0) continue;
    const auto comma = line.find(',');
    Row r{line.substr(0, comma), 0, 0, 0, {}, {}, {}};
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line.substr(comma));
    numbers >> r.theta_i >> r.theta_o >> r.phi >> r.f[0] >> r.f[1] >> r.f[2];
    if (!numbers) continue;
    const double radian = pi / 180;
    r.wo = spherical_direction(r.theta_o * radian, 0.0);
    r.wi = spherical_direction(r.theta_i * radian, r.phi * radian);
    rows.push_back(r);
  }
  return rows;
}

} // namespace nacre::reference_table
