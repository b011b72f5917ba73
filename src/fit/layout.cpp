#include "fit/layout.h"

#include "core/error.h"

#include <cmath>
#include <fmt/format.h>

namespace nacre {
namespace {

/// The parameter named like `parameter` with its final _x as _y; -1 if there is none.
int partner(const ModelInfo& model, std::size_t parameter) {
  const std::string& name = model.parameters[parameter].name;
  if (!name.ends_with("_x")) return -1;
  for (std::size_t i = 0; i < model.parameters.size(); ++i)
    if (model.parameters[i].fitted && model.parameters[i].name == name.substr(0, name.size() - 1) + "y")
      return int(i);
  return -1;
}

} // namespace

double FreeParameter::coordinate(double value) const { return logarithmic ? std::log(value) : value; }
double FreeParameter::value(double coordinate) const {
  return std::clamp(logarithmic ? std::exp(coordinate) : coordinate, lo, hi);
}
double FreeParameter::slope(double coordinate) const { return logarithmic ? std::exp(coordinate) : 1; }

ParameterLayout::ParameterLayout(MaterialSpec start, bool isotropic) : start_(std::move(start)) {
  for (std::size_t lobe = 0; lobe < start_.lobes.size(); ++lobe) {
    const LobeSpec& spec = start_.lobes[lobe];
    if (spec.measured) throw Error(fmt::format("{}: a measured table has no parameters to fit", start_.name));
    const ModelInfo& model = model_infos()[std::size_t(spec.model)];
    auto& index = index_.emplace_back(model.parameters.size(), std::array{-1, -1, -1});
    for (std::size_t p = 0; p < model.parameters.size(); ++p) {
      const ParameterInfo& info = model.parameters[p];
      if (!info.fitted || index[p][0] >= 0) continue;
      const int tied = isotropic ? partner(model, p) : -1;
      for (int channel = 0; channel < 3; ++channel) {
        if (channel == 0 || info.per_channel)
          free_.push_back({int(lobe), int(p), info.per_channel ? channel : -1, info.lo, info.hi,
                           info.lo > 0 && info.hi >= 100 * info.lo, tied});
        index[p][std::size_t(channel)] = size() - 1;
      }
      if (tied >= 0) index[std::size_t(tied)] = index[p];
    }
  }
}

int ParameterLayout::index(int lobe, int parameter, int channel) const {
  return index_[std::size_t(lobe)][std::size_t(parameter)][std::size_t(channel)];
}

std::string ParameterLayout::label(int i) const {
  const FreeParameter& p = (*this)[i];
  const ModelInfo& model = model_infos()[std::size_t(start_.lobes[std::size_t(p.lobe)].model)];
  int same = 0; // lobes of this model: numbered where there are several
  for (const LobeSpec& lobe : start_.lobes)
    same += lobe.model == start_.lobes[std::size_t(p.lobe)].model;
  std::string label = model.name + (same > 1 ? fmt::format("#{}", p.lobe + 1) : "") + "." +
                      model.parameters[std::size_t(p.parameter)].name;
  return p.channel < 0 ? label : label + "." + "rgb"[p.channel];
}

std::vector<double> ParameterLayout::coordinates(const MaterialSpec& material) const {
  std::vector<double> x;
  for (const FreeParameter& p : free_) {
    const LobeSpec& lobe = material.lobes[std::size_t(p.lobe)];
    x.push_back(p.coordinate(lobe.values[std::size_t(p.parameter)][std::size_t(std::max(p.channel, 0))]));
  }
  return x;
}

MaterialSpec ParameterLayout::material(std::span<const double> coordinates) const {
  MaterialSpec material = start_;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const FreeParameter& p = free_[i];
    auto& values = material.lobes[std::size_t(p.lobe)].values;
    const double value = p.value(coordinates[i]);
    for (int channel = 0; channel < 3; ++channel)
      if (p.channel < 0 || p.channel == channel) {
        values[std::size_t(p.parameter)][std::size_t(channel)] = value;
        if (p.tied >= 0) values[std::size_t(p.tied)][std::size_t(channel)] = value;
      }
  }
  return material;
}

} // namespace nacre
