#include "mpm/transfer/Transfer.hpp"

#include "mpm/basis/Bases.hpp"
#include "mpm/core/Simd.hpp"

namespace mpm::transfer {
namespace {

using simd::Pack;

template <int dim>
void append_vector(std::vector<grid::Component>& components) {
  for (int d = 0; d < dim; ++d) components.push_back({d});
}

void add(double* to, Pack x) {
  simd::store(to, simd::load(to) + x);
}

/// (sigma . g)_i for the stress components that this dimension has.
template <int dim>
PackVector<dim> product(const SymmetricTensor& s, const PackVector<dim>& g) {
  if constexpr (dim == 1) return {s[0] * g[0]};
  if constexpr (dim == 2) return {s[0] * g[0] + s[3] * g[1], s[3] * g[0] + s[1] * g[1]};
  if constexpr (dim == 3)
    return {s[0] * g[0] + s[3] * g[1] + s[5] * g[2], s[3] * g[0] + s[1] * g[1] + s[4] * g[2],
            s[5] * g[0] + s[4] * g[1] + s[2] * g[2]};
}

template <int dim>
SymmetricTensor stress_of(const particles::ParticleView<dim>& particles, int p) {
  SymmetricTensor stress;
  for (int k = 0; k < tensor_components<dim>; ++k) stress[k] = particles.stress[k][p];
  return stress;
}

template <int dim>
Vector<dim> sums(const PackVector<dim>& packs) {
  Vector<dim> sum;
  for (int d = 0; d < dim; ++d) sum[d] = simd::sum(packs[d]);
  return sum;
}

}  // namespace

template <int dim>
std::vector<grid::Component> MassMomentumForce<dim>::components() {
  std::vector<grid::Component> components{{grid::Component::scalar}};
  append_vector<dim>(components);
  append_vector<dim>(components);
  return components;
}

template <int dim>
std::vector<grid::Component> VelocityAcceleration<dim>::components() {
  std::vector<grid::Component> components;
  append_vector<dim>(components);
  append_vector<dim>(components);
  return components;
}

template <int dim>
std::vector<grid::Component> NodalVector<dim>::components() {
  std::vector<grid::Component> components;
  append_vector<dim>(components);
  return components;
}

void Increments::cover(const particles::Range& particles, int dim) {
  range = particles;
  const auto count = static_cast<std::size_t>(range.size());
  const int components = dim == 1   ? tensor_components<1>
                         : dim == 2 ? tensor_components<2>
                                    : tensor_components<3>;
  for (int k = 0; k < components; ++k) strain[k].resize(count, 0.0);
  for (int k = 0; k < (dim == 3 ? 3 : dim - 1); ++k) spin[k].resize(count, 0.0);
}

template <int dim, class Basis>
void deposit_mass_momentum_force(const particles::ParticleView<dim>& particles,
                                 Stencil<dim, Basis> stencil,
                                 const ParticleBodyForce<dim>& body_force,
                                 MassMomentumForce<dim> nodes) {
  for (int p = 0; p < particles.count; ++p) {
    const double m_p = particles.mass[p];
    const Vector<dim> v_p = particles.velocity_of(p);
    const Vector<dim> b = body_force[p];
    const SymmetricTensor V_sigma = particles.volume[p] * stress_of(particles, p);
    stencil.move_to(particles.position_of(p));
    stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>& gradient) {
      const Pack m_N = m_p * N;
      const PackVector<dim> f = product<dim>(V_sigma, gradient);
      add(nodes.mass + I, m_N);
      for (int d = 0; d < dim; ++d) {
        add(nodes.momentum[d] + I, m_N * v_p[d]);
        add(nodes.force[d] + I, m_N * b[d] - f[d]);
      }
    });
  }
}

template <int dim, class Basis>
void deposit_mass(const particles::ParticleView<dim>& particles, Stencil<dim, Basis> stencil,
                  double* mass) {
  for (int p = 0; p < particles.count; ++p) {
    stencil.move_to(particles.position_of(p));
    stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>&) {
      add(mass + I, particles.mass[p] * N);
    });
  }
}

namespace {

/// v_p += sum a_I N_Ip dt for one particle after another, then visit(p, v_p), stencil on p.
template <int dim, class Basis, class Visit>
[[gnu::always_inline]] inline void for_each_updated_velocity(
    const particles::ParticleView<dim>& particles, Stencil<dim, Basis>& stencil, double dt,
    double flip_share, VelocityAcceleration<dim> nodes, const Visit& visit) {
  const double share_of_grid = 1.0 - flip_share;
  for (int p = 0; p < particles.count; ++p) {
    stencil.move_to(particles.position_of(p));
    PackVector<dim> change{};
    stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>&) {
      for (int d = 0; d < dim; ++d) change[d] += simd::load(nodes.acceleration[d] + I) * N;
    });
    Vector<dim> v_p = particles.velocity_of(p);
    for (int d = 0; d < dim; ++d) v_p[d] += simd::sum(change[d]) * dt;
    if (share_of_grid > 0.0) {
      PackVector<dim> v{};
      stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>&) {
        for (int d = 0; d < dim; ++d) v[d] += simd::load(nodes.velocity[d] + I) * N;
      });
      for (int d = 0; d < dim; ++d) v_p[d] = flip_share * v_p[d] + share_of_grid * simd::sum(v[d]);
    }
    for (int d = 0; d < dim; ++d) particles.velocity[d][p] = v_p[d];
    visit(p, v_p);
  }
}

}  // namespace

template <int dim, class Basis>
void update_velocities(const particles::ParticleView<dim>& particles, Stencil<dim, Basis> stencil,
                       double dt, double flip_share, VelocityAcceleration<dim> nodes) {
  for_each_updated_velocity<dim, Basis>(particles, stencil, dt, flip_share, nodes,
                                        [](int, const Vector<dim>&) {});
}

template <int dim, class Basis>
void update_velocities_and_deposit_momentum(const particles::ParticleView<dim>& particles,
                                            Stencil<dim, Basis> stencil, double dt,
                                            double flip_share, VelocityAcceleration<dim> nodes,
                                            NodalVector<dim> momentum) {
  for_each_updated_velocity<dim, Basis>(
      particles, stencil, dt, flip_share, nodes, [&](int p, const Vector<dim>& v_p) {
        Vector<dim> m_v;
        for (int d = 0; d < dim; ++d) m_v[d] = particles.mass[p] * v_p[d];
        stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>&) {
          for (int d = 0; d < dim; ++d) add(momentum.value[d] + I, m_v[d] * N);
        });
      });
}

template <int dim, class Basis>
void deposit_affine_momentum(const particles::ParticleView<dim>& particles,
                             Stencil<dim, Basis> stencil, std::array<double*, dim> momentum) {
  for (int p = 0; p < particles.count; ++p) {
    std::array<Vector<dim>, dim> m_C;
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        m_C[i][j] = particles.mass[p] * particles.velocity_gradient[i][j][p];
    stencil.move_to(particles.position_of(p));
    stencil.for_each_moment_row([&](std::ptrdiff_t I, Pack, const PackVector<dim>& N_r) {
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) add(momentum[i] + I, m_C[i][j] * N_r[j]);
    });
  }
}

template <int dim, class Basis>
void gather_velocity_gradient(const particles::ParticleView<dim>& particles,
                              Stencil<dim, Basis> stencil, std::array<double*, dim> velocity) {
  for (int p = 0; p < particles.count; ++p) {
    std::array<PackVector<dim>, dim> B{};
    stencil.move_to(particles.position_of(p));
    stencil.for_each_moment_row([&](std::ptrdiff_t I, Pack, const PackVector<dim>& N_r) {
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) B[i][j] += simd::load(velocity[i] + I) * N_r[j];
    });
    for (int j = 0; j < dim; ++j) {
      // Where one node has all the weight there is no gradient to be seen.
      const double D = stencil.second_moment(j);
      const double inverse = D > 0.0 ? 1.0 / D : 0.0;
      for (int i = 0; i < dim; ++i)
        particles.velocity_gradient[i][j][p] = simd::sum(B[i][j]) * inverse;
    }
  }
}

namespace {

/// Sums over the rows of a stencil, of four particles; sum() gives each particle a lane.
struct RowSums {
  std::array<Pack, simd::lanes> of_particle{};
  Pack sum() const {
    return simd::sums(of_particle[0], of_particle[1], of_particle[2], of_particle[3]);
  }
};

/// Velocity and its gradient at four particles before the last sum.
template <int dim>
struct GatheredMotion {
  std::array<RowSums, dim> v;
  std::array<std::array<RowSums, dim>, dim> L;  ///< L[i][j] = dv_i/dx_j
};

/// D dt and W dt of four particles from their velocity gradients.
template <int dim>
void store_increments(const GatheredMotion<dim>& motion, double dt, int offset, int n,
                      Increments& increments) {
  const auto store = [&](std::vector<double>& column, Pack value) {
    simd::store(column.data() + offset, value * dt, n);
  };
  std::array<PackVector<dim>, dim> L;
  for (int i = 0; i < dim; ++i)
    for (int j = 0; j < dim; ++j) L[i][j] = motion.L[i][j].sum();
  for (int i = 0; i < dim; ++i) store(increments.strain[i], L[i][i]);
  if constexpr (dim >= 2) {
    store(increments.strain[3], 0.5 * (L[0][1] + L[1][0]));
    store(increments.spin[0], 0.5 * (L[0][1] - L[1][0]));
  }
  if constexpr (dim == 3) {
    store(increments.strain[4], 0.5 * (L[1][2] + L[2][1]));
    store(increments.strain[5], 0.5 * (L[0][2] + L[2][0]));
    store(increments.spin[1], 0.5 * (L[1][2] - L[2][1]));
    store(increments.spin[2], 0.5 * (L[0][2] - L[2][0]));
  }
}

}  // namespace

template <int dim, class Basis>
Drift gather_increments_and_move(const particles::ParticleView<dim>& particles,
                                 const particles::Range& range, Stencil<dim, Basis> stencil,
                                 const AdvanceTimes& dt, VelocityAcceleration<dim> nodes,
                                 NodalVector<dim> strain_velocity, const grid::Grid<dim>& grid,
                                 Increments& increments) {
  Drift drift;
  increments.cover(range, dim);
  const grid::Box<dim> everywhere = grid.all_cells();
  const grid::CellSet<dim>& active = grid.active_cells();
  simd::for_each_group(range.size(), [&](int offset, int n) {
    const int first = range.first + offset;
    GatheredMotion<dim> motion;
    std::array<std::array<int, dim>, simd::lanes> old_cell;
    for (int lane = 0; lane < n; ++lane) {
      stencil.move_to(particles.position_of(first + lane));
      old_cell[lane] = stencil.cell();
      PackVector<dim> v{};
      std::array<PackVector<dim>, dim> L{};
      stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>& gradient) {
        for (int i = 0; i < dim; ++i) {
          v[i] += simd::load(nodes.velocity[i] + I) * N;
          const Pack u_i = simd::load(strain_velocity.value[i] + I);
          for (int j = 0; j < dim; ++j) L[i][j] += u_i * gradient[j];
        }
      });
      for (int i = 0; i < dim; ++i) {
        motion.v[i].of_particle[lane] = v[i];
        for (int j = 0; j < dim; ++j) motion.L[i][j].of_particle[lane] = L[i][j];
      }
    }
    for (int i = 0; i < dim; ++i) {
      const Pack change = motion.v[i].sum() * dt.move;
      double *const x = particles.position[i] + first, *const u = particles.displacement[i] + first;
      simd::store(x, simd::load(x, n) + change, n);
      simd::store(u, simd::load(u, n) + change, n);
    }
    store_increments<dim>(motion, dt.strain, offset, n, increments);
    for (int lane = 0; lane < n; ++lane) {
      const Vector<dim> x = particles.position_of(first + lane);
      if (stencil.holds(old_cell[lane], x)) continue;
      const auto cell = grid.cell_of(x);
      if (active.contains(cell)) continue;
      drift.must_migrate = true;
      if (!everywhere.contains(cell)) drift.lost = first + lane;
    }
  });
  return drift;
}

namespace {

template <int dim>
double volume_change(const Increments& increments, int p) {
  double sum = 0.0;
  for (int d = 0; d < dim; ++d) sum += increments.strain[d][p];
  return sum;
}

}  // namespace

template <int dim, class Basis>
void deposit_volume_change(const particles::ParticleView<dim>& particles,
                           Stencil<dim, Basis> stencil, const Increments& increments,
                           double* volume, double* change) {
  for (int p = 0; p < particles.count; ++p) {
    const double V_p = particles.volume[p];
    const double V_theta = V_p * volume_change<dim>(increments, p);
    stencil.move_to(particles.position_of(p));
    stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>&) {
      add(volume + I, V_p * N);
      add(change + I, V_theta * N);
    });
  }
}

template <int dim, class Basis>
void blend_volume_change(const particles::ParticleView<dim>& particles, Stencil<dim, Basis> stencil,
                         const double* change, double share, Increments& increments) {
  for (int p = 0; p < particles.count; ++p) {
    Pack theta_rows{};
    stencil.move_to(particles.position_of(p));
    stencil.for_each_row([&](std::ptrdiff_t I, Pack N, const PackVector<dim>&) {
      theta_rows += simd::load(change + I) * N;
    });
    const double theta = simd::sum(theta_rows);
    // Spread over the directions that deform: plane strain stays plane strain.
    const double correction = share * (theta - volume_change<dim>(increments, p)) / dim;
    for (int d = 0; d < dim; ++d) increments.strain[d][p] += correction;
  }
}

#define MPM_INSTANTIATE(dim, Basis)                                                                \
  template void deposit_mass_momentum_force<dim, Basis>(                                           \
      const particles::ParticleView<dim>&, Stencil<dim, Basis>, const ParticleBodyForce<dim>&,     \
      MassMomentumForce<dim>);                                                                     \
  template void update_velocities_and_deposit_momentum<dim, Basis>(                                \
      const particles::ParticleView<dim>&, Stencil<dim, Basis>, double, double,                    \
      VelocityAcceleration<dim>, NodalVector<dim>);                                                \
  template void update_velocities<dim, Basis>(const particles::ParticleView<dim>&,                 \
                                              Stencil<dim, Basis>, double, double,                 \
                                              VelocityAcceleration<dim>);                          \
  template void deposit_mass<dim, Basis>(const particles::ParticleView<dim>&, Stencil<dim, Basis>, \
                                         double*);                                                 \
  template void deposit_affine_momentum<dim, Basis>(                                               \
      const particles::ParticleView<dim>&, Stencil<dim, Basis>, std::array<double*, dim>);         \
  template void gather_velocity_gradient<dim, Basis>(                                              \
      const particles::ParticleView<dim>&, Stencil<dim, Basis>, std::array<double*, dim>);         \
  template void deposit_volume_change<dim, Basis>(const particles::ParticleView<dim>&,             \
                                                  Stencil<dim, Basis>, const Increments&, double*, \
                                                  double*);                                        \
  template void blend_volume_change<dim, Basis>(const particles::ParticleView<dim>&,               \
                                                Stencil<dim, Basis>, const double*, double,        \
                                                Increments&);                                      \
  template Drift gather_increments_and_move<dim, Basis>(                                           \
      const particles::ParticleView<dim>&, const particles::Range&, Stencil<dim, Basis>,           \
      const AdvanceTimes&, VelocityAcceleration<dim>, NodalVector<dim>, const grid::Grid<dim>&,    \
      Increments&);
#define MPM_INSTANTIATE_FOR_DIMENSION(dim)   \
  template struct MassMomentumForce<dim>;    \
  template struct VelocityAcceleration<dim>; \
  template struct NodalVector<dim>;

MPM_INSTANTIATE_FOR_DIMENSION(1)
MPM_INSTANTIATE_FOR_DIMENSION(2)
MPM_INSTANTIATE_FOR_DIMENSION(3)
MPM_BASES(MPM_IN_ALL_DIMENSIONS)

}  // namespace mpm::transfer
