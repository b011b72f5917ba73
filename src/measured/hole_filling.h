#pragma once
// Values where a table has holes, on request only.
//
// Holes above the horizon are filled, in this order, and marked; those below it mean nothing and stay.
//   1. Reciprocity: a table that holds the whole circle of phi_d has the value at phi_d + pi.
//   2. Mirror image: isotropic reflectance without handedness has the value at -phi_d.
//   3. Extrapolation, channel by channel, of log f over (theta_h, theta_d, phi_d). First log f is split into
//   a
//      function of theta_h plus a function of theta_d, fitted to what is known by alternating means: a
//      microfacet model's D and F (Cook and Torrance 1982). The remainder is a membrane over the table's
//      nodes, fixed where f is known and free elsewhere: it minimises sum w_a (r_p - r_q)^2 over neighbours
//      p, q, w_a the inverse mean square of such differences along the axis a, as the table itself shows
//      them. This is the most probable remainder if steps along an axis are independent and normal; it solves
//      a discrete Laplace equation, so it lies between the smallest and the largest remainder that is known.

#include "measured/merl_table.h"

namespace nacre {

struct FilledTable {
  MerlTable table; ///< measured entries bit for bit as before, is_filled where filled
  std::size_t by_reciprocity = 0, by_mirror_image = 0, by_extrapolation = 0; ///< entries
};

/// Some 2 s for a full table with a third of it missing. @throws Error if nothing was measured
FilledTable fill_holes(const MerlTable& table);

} // namespace nacre
