#pragma once
// What the build makes of a model: its description and its functions for every number type. Included by the
// generated source of each header of bsdf/models, and by nothing else.

#include "bsdf/model_functions.h"
#include "bsdf/model_info.h"
#include "core/pack.h"
#include "optics/masking_table.h"
#include "optics/microfacet.h"

namespace nacre {

struct CompiledModel {
  ModelInfo (*describe)();
  ModelFunctions<float, 4> float_4;
  ModelFunctions<double, 3> double_3;
  ModelFunctions<Pack, 3> pack_3;
  ModelDerivatives derivatives;
  FacetFunctions facets;
};

template <class M>
ModelInfo describe_model() {
  static_assert(ScatteringModel<M>);
  ModelInfo info{std::string(M::name), std::string(M::source), std::string(M::summary), M::laws, {}};
  for_each_parameter<M>([&](const auto& p) {
    info.parameters.push_back({std::string(p.name), std::string(p.unit), std::string(p.meaning), p.lo, p.hi,
                               p.initial, p.per_channel, p.fitted});
  });
  return info;
}

/// A model in packs with something that depends on its parameters alone and takes long to compute: what
/// `prepare` returns, to be used if `prepared` points to it.
template <class M>
concept Preparable = pack_derivatives<typename M::Number>
>= 0 && requires(M m) {
  m.prepare();
  m.prepared;
};
template <class M>
using Prepared = decltype(std::declval<const M>().prepare());

template <class M>
struct FunctionsOf {
  using R = typename M::Number;
  static_assert(parameter_count<M>() <= max_parameter_numbers<M::channel_count>);
  static typename M::Color eval(const R* values, const Vec3<R>& wo, const Vec3<R>& wi) {
    return from_vector<M>(values).eval(wo, wi);
  }
  static R pdf(const R* values, const Vec3<R>& wo, const Vec3<R>& wi) {
    return from_vector<M>(values).pdf(wo, wi);
  }
  static BsdfSample<R, M::channel_count> sample(const R* values, const Vec3<R>& wo, const R& u_lobe,
                                                const Vec2<R>& u) {
    return from_vector<M>(values).sample(wo, u_lobe, u);
  }
  static constexpr ModelFunctions<R, M::channel_count> all() {
    ModelFunctions<R, M::channel_count> functions{&eval, &pdf, &sample};
    if constexpr (Preparable<M>) {
      functions.prepare = [](const R* values) -> std::shared_ptr<const void> {
        return std::make_shared<const Prepared<M>>(from_vector<M>(values).prepare());
      };
      functions.eval_prepared = [](const R* values, const void* prepared, const Vec3<R>& wo,
                                   const Vec3<R>& wi) {
        M model = from_vector<M>(values);
        model.prepared = static_cast<const Prepared<M>*>(prepared);
        return model.eval(wo, wi);
      };
    }
    return functions;
  }
};

template <template <class, int> class Model>
struct DerivativesOf {
  static constexpr int count = [] {
    int n = 0;
    for_each_parameter<Model<float, 1>>([&](const auto& p) { n += p.fitted; });
    return n;
  }();
  /// Derivatives carried at once: more than some six no longer fit the registers, and take longer to compile.
  static constexpr int width = count <= 6 ? std::max(count, 1) : 4;

  static void evaluate(std::span<const double> values, std::span<const int> parameters,
                       const DirectionArrays& at, std::size_t n, float* f, float* df) {
    if (!df || parameters.empty()) return values_alone(values, at, n, f);
    for (std::size_t first = 0; first < parameters.size(); first += std::size_t(width)) {
      const auto carried = parameters.subspan(first, std::min(parameters.size() - first, std::size_t(width)));
      with_derivatives(values, carried, at, n, f, df + first * n);
    }
  }
  static constexpr ModelDerivatives all{count, &evaluate};

private:
  template <class R>
  static Vec3<R> direction(const std::array<const float*, 3>& w, std::size_t i) {
    return {R(load(w[0] + i)), R(load(w[1] + i)), R(load(w[2] + i))};
  }
  /// Gives the model what it prepared when it last had these values in this thread: blocks of a fit come one
  /// after another.
  template <class M>
  static void prepare([[maybe_unused]] M& model, [[maybe_unused]] std::span<const double> values,
                      [[maybe_unused]] std::span<const int> carried) {
    if constexpr (Preparable<M>) {
      struct Known {
        std::vector<double> values;
        std::vector<int> carried;
        std::shared_ptr<const Prepared<M>> prepared;
      };
      thread_local std::array<Known, 4> known; // two lobes of the same model, each in two parts
      thread_local std::size_t oldest = 0;
      auto found = std::find_if(known.begin(), known.end(), [&](const Known& k) {
        return std::equal(values.begin(), values.end(), k.values.begin(), k.values.end()) &&
               std::equal(carried.begin(), carried.end(), k.carried.begin(), k.carried.end());
      });
      if (found == known.end()) {
        found = known.begin() + std::ptrdiff_t(oldest++ % known.size());
        *found = {{values.begin(), values.end()},
                  {carried.begin(), carried.end()},
                  std::make_shared<const Prepared<M>>(model.prepare())};
      }
      model.prepared = found->prepared.get();
    }
  }
  static void values_alone(std::span<const double> values, const DirectionArrays& at, std::size_t n,
                           float* f) {
    std::vector<Pack> packs;
    for (const double x : values)
      packs.push_back(constant<Pack>(x));
    auto model = from_vector<Model<Pack, 1>>(packs.data());
    prepare(model, values, {});
    for (std::size_t i = 0; i < n; i += pack_width)
      store(f + i, model.eval(direction<Pack>(at.wo, i), direction<Pack>(at.wi, i))[0]);
  }
  static void with_derivatives(std::span<const double> values, std::span<const int> carried,
                               const DirectionArrays& at, std::size_t n, float* f, float* df) {
    using R = Dual<Pack, width>;
    std::vector<R> numbers;
    for (const double x : values)
      numbers.push_back(R(constant<Pack>(x)));
    for (std::size_t k = 0; k < carried.size(); ++k)
      numbers[std::size_t(carried[k])].d[k] = Pack(1.0f);
    auto model = from_vector<Model<R, 1>>(numbers.data());
    prepare(model, values, carried);
    for (std::size_t i = 0; i < n; i += pack_width) {
      const R y = model.eval(direction<R>(at.wo, i), direction<R>(at.wi, i))[0];
      store(f + i, y.v);
      for (std::size_t k = 0; k < carried.size(); ++k)
        store(df + k * n + i, y.d[k]);
    }
  }
};

/// FacetFunctions of a model that offers `distribution()`.
template <class M>
struct FacetsOf {
  static double D(const double* values, const Vec3d& wm) {
    return from_vector<M>(values).distribution().D(wm);
  }
  static double G1(const double* values, const Vec3d& w, const Vec3d& wm) {
    const M m = from_vector<M>(values);
    if constexpr (requires { m.masking(w, wm); })
      return m.masking(w, wm);
    else
      return dot(w, wm) > 0 && w.z > 0 ? smith_g1(m.distribution(), w) : 0;
  }
  static double G2(const double* values, const Vec3d& wo, const Vec3d& wi) {
    const M m = from_vector<M>(values);
    if (!(wo.z > 0 && wi.z > 0)) return 0;
    if constexpr (requires { m.masking_shadowing(wo, wi); })
      return m.masking_shadowing(wo, wi);
    else if constexpr (requires { m.separable; })
      return 4 * wo.z * wi.z * visibility(m.distribution(), wo, wi, m.separable);
    else
      return 4 * wo.z * wi.z * visibility(m.distribution(), wo, wi, 0.0);
  }
  static constexpr FacetFunctions all() {
    if constexpr (requires(const M m, Vec3d w) {
                    m.distribution().D(w);
                    m.distribution().lambda_cos(w);
                  })
      return {&D, &G1, &G2};
    else
      return {};
  }
};

template <template <class, int> class Model>
constexpr CompiledModel compile_model() {
  return {&describe_model<Model<float, 3>>,
          FunctionsOf<Model<float, 4>>::all(),
          FunctionsOf<Model<double, 3>>::all(),
          FunctionsOf<Model<Pack, 3>>::all(),
          DerivativesOf<Model>::all,
          FacetsOf<Model<double, 3>>::all()};
}

#define NACRE_COMPILE_MODEL(Model)                                                                           \
  extern const CompiledModel compiled_##Model;                                                               \
  constinit const CompiledModel compiled_##Model = compile_model<Model>();

} // namespace nacre
