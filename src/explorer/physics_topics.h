#pragma once
// The topics of physics pages: docs/explorer-protocol.md, "Physics".

#include "explorer/desk.h"

namespace nacre {

struct PhysicsTopic {
  std::string_view name, formula, source;
  Answer (*answer)(const Arguments& request, const Desk& desk);
};
const std::vector<PhysicsTopic>& physics_topics();

/// Puts curves over x into an answer: arrays x and y, labels and names in the header.
class CurveAnswer {
public:
  CurveAnswer(std::string x_label, std::string y_label, std::vector<std::string> series);
  /// One value a series.
  void add(double x, std::initializer_list<double> y);
  /// A number of the answer; null where it is not finite.
  void value(const char* name, double x);
  nlohmann::json& header() { return answer_.header; }
  void array(std::string name, std::vector<std::size_t> shape, std::vector<float> data);
  Answer finish();

private:
  Answer answer_;
  std::size_t series_;
  std::vector<float> x_;
  std::vector<std::vector<float>> y_;
};

Answer answer_ndf(const Arguments& request, const Desk& desk);
Answer answer_visible_normals(const Arguments& request, const Desk& desk);
Answer answer_masking(const Arguments& request, const Desk& desk);
Answer answer_projected_area(const Arguments& request, const Desk& desk);
Answer answer_multiple_bounces(const Arguments& request, const Desk& desk);

} // namespace nacre
