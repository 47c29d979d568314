#include <algorithm>
#include <limits>

#include "ExplicitStep.hpp"
#include "mpm/basis/Bases.hpp"
#include "mpm/core/Simd.hpp"

namespace mpm::solver {
namespace {

/// The smallest span of the functions that reach the cell of a particle; sorted particles mostly
/// stay in the cell of the one before.
template <int dim, class Basis>
class SmallestSpan {
 public:
  explicit SmallestSpan(const std::array<Basis, dim>& bases) : m_bases(bases) {}

  double at(const Vector<dim>& x) {
    double span = std::numeric_limits<double>::max();
    for (int d = 0; d < dim; ++d) {
      m_cell[d] = m_bases[d].lines().cell_near(m_cell[d], x[d]);
      span = std::min(span, m_bases[d].smallest_span(m_cell[d]));
    }
    return span;
  }

 private:
  const std::array<Basis, dim>& m_bases;
  std::array<int, dim> m_cell{};
};

/// Of its own wave speed. Bodies may fly or be turned by hand (`-scene rotation` with 65 times that
/// of a very soft one), but no motion that a grid can follow is so fast.
constexpr double largest_speed = 300.0;

}  // namespace

template <int dim, class Basis>
Transit ExplicitStep<dim, Basis>::transit() const {
  const particles::ParticleView<dim> view = m_parts.particles.view();
  Transit transit;
  SmallestSpan<dim, Basis> smallest_span(m_parts.bases);
  std::vector<double> modulus;
  for (std::size_t k = 0; k < m_parts.particles.materials().size(); ++k) {
    const auto range = m_parts.particles.range_of(static_cast<int>(k));
    const material::Batch batch = m_parts.particles.batch_of(view, static_cast<int>(k));
    modulus.resize(batch.size);
    m_parts.particles.materials()[k]->wave_modulus(batch, modulus);
    simd::for_each_group(static_cast<int>(batch.size), [&](int offset, int n) {
      const int first = range.first + offset;
      simd::Pack square{}, span{};
      for (int d = 0; d < dim; ++d) {
        const simd::Pack v = simd::load(view.velocity[d] + first, n);
        square += v * v;
      }
      for (int lane = 0; lane < simd::lanes; ++lane)
        span[lane] = smallest_span.at(view.position_of(first + std::min(lane, n - 1)));
      const simd::Pack density =
          simd::load(view.mass + first, n) / simd::load(view.volume + first, n);
      const simd::Pack c = simd::sqrt(simd::load(modulus.data() + offset, n) / density);
      const simd::Pack speed = simd::sqrt(square), time = span / (c + speed);
      for (int lane = 0; lane < n; ++lane) {
        if (time[lane] < transit.smallest) {
          transit.smallest = time[lane];
          transit.of_particle = first + lane;
        }
        if (c[lane] > 0.0 && speed[lane] > largest_speed * c[lane]) transit.runaway = first + lane;
      }
    });
  }
  return transit;
}

#define MPM_INSTANTIATE(dim, Basis) template Transit ExplicitStep<dim, Basis>::transit() const;
MPM_BASES(MPM_IN_ALL_DIMENSIONS)

}  // namespace mpm::solver
