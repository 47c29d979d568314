#include "mpm/transfer/Transfer.hpp"

#include <cmath>

#include "mpm/basis/Bases.hpp"

namespace mpm::transfer {
namespace {

template <int dim>
void append_vector(std::vector<grid::Component>& components) {
  for (int d = 0; d < dim; ++d) components.push_back({d});
}

/// (sigma . g)_i for the stress components that this dimension has.
template <int dim>
Vector<dim> product(const SymmetricTensor& s, const Vector<dim>& g) {
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

/// sum u_I N_I.
template <int dim, class Basis>
Vector<dim> interpolate(const Stencil<dim, Basis>& stencil, const std::array<double*, dim>& u) {
  Vector<dim> sum{};
  stencil.for_each_node([&](std::ptrdiff_t I, double N, const Vector<dim>&) {
    for (int d = 0; d < dim; ++d) sum[d] += u[d][I] * N;
  });
  return sum;
}

template <int dim>
Vector<dim> body_acceleration(const particles::ParticleView<dim>& particles,
                              const BodyForce<dim>& body_force, int p) {
  if (!body_force.at_reference_position) return body_force.uniform;
  Vector<dim> X = particles.position_of(p);
  for (int d = 0; d < dim; ++d) X[d] -= particles.displacement[d][p];
  return body_force.at_reference_position(X);
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

void Increments::resize(std::size_t particles, int dim) {
  const int tensor = dim == 1 ? tensor_components<1> : tensor_components<2>;
  for (int k = 0; k < (dim == 3 ? tensor_components<3> : tensor); ++k)
    strain[static_cast<std::size_t>(k)].resize(particles, 0.0);
  for (int k = 0; k < (dim == 3 ? 3 : dim - 1); ++k)
    spin[static_cast<std::size_t>(k)].resize(particles, 0.0);
}

template <int dim, class Basis>
void deposit_mass_momentum_force(const particles::ParticleView<dim>& particles,
                                 Stencil<dim, Basis> stencil, const BodyForce<dim>& body_force,
                                 const MassMomentumForce<dim>& nodes) {
  for (int p = 0; p < particles.count; ++p) {
    const double m_p = particles.mass[p];
    const Vector<dim> v_p = particles.velocity_of(p);
    const Vector<dim> b = body_acceleration(particles, body_force, p);
    const SymmetricTensor V_sigma = particles.volume[p] * stress_of(particles, p);
    stencil.move_to(particles.position_of(p));
    stencil.for_each_node([&](std::ptrdiff_t I, double N, const Vector<dim>& gradient) {
      const double m_N = m_p * N;
      const Vector<dim> f = product<dim>(V_sigma, gradient);
      nodes.mass[I] += m_N;
      for (int d = 0; d < dim; ++d) {
        nodes.momentum[d][I] += m_N * v_p[d];
        nodes.force[d][I] += m_N * b[d] - f[d];
      }
    });
  }
}

template <int dim, class Basis>
void deposit_mass(const particles::ParticleView<dim>& particles, Stencil<dim, Basis> stencil,
                  double* mass) {
  for (int p = 0; p < particles.count; ++p) {
    stencil.move_to(particles.position_of(p));
    stencil.for_each_node(
        [&](std::ptrdiff_t I, double N, const Vector<dim>&) { mass[I] += particles.mass[p] * N; });
  }
}

/// The particle's velocity after Eq. 7, a share of it the grid's own.
template <int dim, class Basis>
Vector<dim> updated_velocity(const Vector<dim>& old, const Stencil<dim, Basis>& stencil, double dt,
                             double flip_share, const VelocityAcceleration<dim>& nodes) {
  const Vector<dim> a_p = interpolate<dim, Basis>(stencil, nodes.acceleration);
  Vector<dim> v_p = old;
  for (int d = 0; d < dim; ++d) v_p[d] += a_p[d] * dt;
  if (flip_share >= 1.0) return v_p;
  const Vector<dim> v_grid = interpolate<dim, Basis>(stencil, nodes.velocity);
  for (int d = 0; d < dim; ++d) v_p[d] = flip_share * v_p[d] + (1.0 - flip_share) * v_grid[d];
  return v_p;
}

template <int dim, class Basis>
void update_velocities(const particles::ParticleView<dim>& particles, Stencil<dim, Basis> stencil,
                       double dt, double flip_share, const VelocityAcceleration<dim>& nodes) {
  for (int p = 0; p < particles.count; ++p) {
    stencil.move_to(particles.position_of(p));
    const Vector<dim> v_p =
        updated_velocity<dim, Basis>(particles.velocity_of(p), stencil, dt, flip_share, nodes);
    for (int d = 0; d < dim; ++d) particles.velocity[d][p] = v_p[d];
  }
}

template <int dim, class Basis>
void update_velocities_and_deposit_momentum(const particles::ParticleView<dim>& particles,
                                            Stencil<dim, Basis> stencil, double dt,
                                            double flip_share,
                                            const VelocityAcceleration<dim>& nodes,
                                            const NodalVector<dim>& momentum) {
  for (int p = 0; p < particles.count; ++p) {
    stencil.move_to(particles.position_of(p));
    const Vector<dim> v_p =
        updated_velocity<dim, Basis>(particles.velocity_of(p), stencil, dt, flip_share, nodes);
    const double m_p = particles.mass[p];
    for (int d = 0; d < dim; ++d) particles.velocity[d][p] = v_p[d];
    stencil.for_each_node([&](std::ptrdiff_t I, double N, const Vector<dim>&) {
      for (int d = 0; d < dim; ++d) momentum.value[d][I] += m_p * v_p[d] * N;
    });
  }
}

template <int dim, class Basis>
void deposit_affine_momentum(const particles::ParticleView<dim>& particles,
                             Stencil<dim, Basis> stencil,
                             const std::array<double*, dim>& momentum) {
  for (int p = 0; p < particles.count; ++p) {
    std::array<Vector<dim>, dim> m_C;
    for (int i = 0; i < dim; ++i)
      for (int j = 0; j < dim; ++j)
        m_C[i][j] = particles.mass[p] * particles.velocity_gradient[i][j][p];
    stencil.move_to(particles.position_of(p));
    stencil.for_each_moment([&](std::ptrdiff_t I, double, const Vector<dim>& N_r) {
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) momentum[i][I] += m_C[i][j] * N_r[j];
    });
  }
}

template <int dim, class Basis>
void gather_velocity_gradient(const particles::ParticleView<dim>& particles,
                              Stencil<dim, Basis> stencil,
                              const std::array<double*, dim>& velocity) {
  for (int p = 0; p < particles.count; ++p) {
    std::array<Vector<dim>, dim> B{};
    stencil.move_to(particles.position_of(p));
    stencil.for_each_moment([&](std::ptrdiff_t I, double, const Vector<dim>& N_r) {
      for (int i = 0; i < dim; ++i)
        for (int j = 0; j < dim; ++j) B[i][j] += velocity[i][I] * N_r[j];
    });
    for (int j = 0; j < dim; ++j) {
      // Where one node has all the weight there is no gradient to be seen.
      const double D = stencil.second_moment(j);
      const double inverse = D > 0.0 ? 1.0 / D : 0.0;
      for (int i = 0; i < dim; ++i) particles.velocity_gradient[i][j][p] = B[i][j] * inverse;
    }
  }
}

template <int dim, class Basis>
Drift gather_increments_and_move(const particles::ParticleView<dim>& particles,
                                 Stencil<dim, Basis> stencil, const AdvanceTimes& dt,
                                 const VelocityAcceleration<dim>& nodes,
                                 const NodalVector<dim>& strain_velocity,
                                 const grid::Grid<dim>& grid, Increments& increments) {
  Drift drift;
  increments.resize(static_cast<std::size_t>(particles.count), dim);
  const grid::Box<dim> everywhere = grid.all_cells();
  const grid::CellSet<dim> active = grid.active_cells();
  for (int p = 0; p < particles.count; ++p) {
    stencil.move_to(particles.position_of(p));
    Vector<dim> v{};
    std::array<Vector<dim>, dim> L{};  // L[i][j] = dv_i/dx_j
    stencil.for_each_node([&](std::ptrdiff_t I, double N, const Vector<dim>& gradient) {
      for (int i = 0; i < dim; ++i) {
        v[i] += nodes.velocity[i][I] * N;
        for (int j = 0; j < dim; ++j) L[i][j] += strain_velocity.value[i][I] * gradient[j];
      }
    });
    Vector<dim> x = particles.position_of(p);
    for (int i = 0; i < dim; ++i) {
      x[i] += v[i] * dt.move;
      particles.position[i][p] = x[i];
      particles.displacement[i][p] += v[i] * dt.move;
      increments.strain[i][p] = L[i][i] * dt.strain;
    }
    if constexpr (dim >= 2) {
      increments.strain[3][p] = 0.5 * (L[0][1] + L[1][0]) * dt.strain;
      increments.spin[0][p] = 0.5 * (L[0][1] - L[1][0]) * dt.strain;
    }
    if constexpr (dim == 3) {
      increments.strain[4][p] = 0.5 * (L[1][2] + L[2][1]) * dt.strain;
      increments.strain[5][p] = 0.5 * (L[0][2] + L[2][0]) * dt.strain;
      increments.spin[1][p] = 0.5 * (L[1][2] - L[2][1]) * dt.strain;
      increments.spin[2][p] = 0.5 * (L[0][2] - L[2][0]) * dt.strain;
    }
    const auto cell = grid.cell_of(x);
    if (!active.contains(cell)) {
      drift.must_migrate = true;
      if (!everywhere.contains(cell)) drift.lost = p;
    }
  }
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
    stencil.for_each_node([&](std::ptrdiff_t I, double N, const Vector<dim>&) {
      volume[I] += V_p * N;
      change[I] += V_theta * N;
    });
  }
}

template <int dim, class Basis>
void replace_volume_change(const particles::ParticleView<dim>& particles,
                           Stencil<dim, Basis> stencil, const double* change,
                           Increments& increments) {
  for (int p = 0; p < particles.count; ++p) {
    double theta = 0.0;
    stencil.move_to(particles.position_of(p));
    stencil.for_each_node(
        [&](std::ptrdiff_t I, double N, const Vector<dim>&) { theta += change[I] * N; });
    // Spread over the directions that deform: plane strain stays plane strain.
    const double correction = (theta - volume_change<dim>(increments, p)) / dim;
    for (int d = 0; d < dim; ++d) increments.strain[d][p] += correction;
  }
}

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

/// Hughes-Winget rotation of the spin w = (W_xy, W_yz, W_xz) dt: Q = 1 + (W + W^2/2)/(1 + w.w/4)
/// with W the skew matrix, the closed form of (1 - W/2)^-1 (1 + W/2).
Matrix rotation(double xy, double yz, double xz) {
  const Matrix W{{{0.0, xy, xz}, {-xy, 0.0, yz}, {-xz, -yz, 0.0}}};
  const double factor = 1.0 / (1.0 + 0.25 * (xy * xy + yz * yz + xz * xz));
  Matrix Q;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      double square = 0.0;
      for (int k = 0; k < 3; ++k) square += W[i][k] * W[k][j];
      Q[i][j] = (i == j ? 1.0 : 0.0) + factor * (W[i][j] + 0.5 * square);
    }
  return Q;
}

SymmetricTensor rotate(const Matrix& Q, const SymmetricTensor& s) {
  const Matrix S{{{s[0], s[3], s[5]}, {s[3], s[1], s[4]}, {s[5], s[4], s[2]}}};
  Matrix QS{}, R{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) QS[i][j] += Q[i][k] * S[k][j];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) R[i][j] += QS[i][k] * Q[j][k];
  return {{R[0][0], R[1][1], R[2][2], R[0][1], R[1][2], R[0][2]}};
}

/// Rotation in the plane: c and s of the angle 2 atan(w/2), exact in the Cayley form.
void rotate_in_plane(double w, double& xx, double& yy, double& xy) {
  const double factor = 1.0 / (1.0 + 0.25 * w * w);
  const double c = (1.0 - 0.25 * w * w) * factor, s = w * factor;  // Q = [c s; -s c]
  const double a = xx, b = yy, t = xy;
  xx = c * c * a + 2.0 * c * s * t + s * s * b;
  yy = s * s * a - 2.0 * c * s * t + c * c * b;
  xy = c * s * (b - a) + (c * c - s * s) * t;
}

}  // namespace

template <int dim>
void rotate_and_expand(const particles::ParticleView<dim>& particles,
                       const Increments& increments) {
  for (int p = 0; p < particles.count; ++p) {
    SymmetricTensor e;
    for (int k = 0; k < tensor_components<dim>; ++k) e[k] = increments.strain[k][p];
    particles.volume[p] *= std::exp(trace(e));
    particles.deviatoric_strain[p] += std::sqrt(2.0 / 3.0) * norm(deviator(e));
    if constexpr (dim == 2)
      rotate_in_plane(increments.spin[0][p], particles.stress[0][p], particles.stress[1][p],
                      particles.stress[3][p]);
    if constexpr (dim == 3) {
      const Matrix Q =
          rotation(increments.spin[0][p], increments.spin[1][p], increments.spin[2][p]);
      const SymmetricTensor rotated = rotate(Q, stress_of(particles, p));
      for (int k = 0; k < SymmetricTensor::size; ++k) particles.stress[k][p] = rotated[k];
    }
  }
}

#define MPM_INSTANTIATE(dim, Basis)                                                                \
  template void deposit_mass_momentum_force<dim, Basis>(                                           \
      const particles::ParticleView<dim>&, Stencil<dim, Basis>, const BodyForce<dim>&,             \
      const MassMomentumForce<dim>&);                                                              \
  template void update_velocities_and_deposit_momentum<dim, Basis>(                                \
      const particles::ParticleView<dim>&, Stencil<dim, Basis>, double, double,                    \
      const VelocityAcceleration<dim>&, const NodalVector<dim>&);                                  \
  template void update_velocities<dim, Basis>(const particles::ParticleView<dim>&,                 \
                                              Stencil<dim, Basis>, double, double,                 \
                                              const VelocityAcceleration<dim>&);                   \
  template void deposit_mass<dim, Basis>(const particles::ParticleView<dim>&, Stencil<dim, Basis>, \
                                         double*);                                                 \
  template void deposit_affine_momentum<dim, Basis>(                                               \
      const particles::ParticleView<dim>&, Stencil<dim, Basis>, const std::array<double*, dim>&);  \
  template void gather_velocity_gradient<dim, Basis>(                                              \
      const particles::ParticleView<dim>&, Stencil<dim, Basis>, const std::array<double*, dim>&);  \
  template void deposit_volume_change<dim, Basis>(const particles::ParticleView<dim>&,             \
                                                  Stencil<dim, Basis>, const Increments&, double*, \
                                                  double*);                                        \
  template void replace_volume_change<dim, Basis>(                                                 \
      const particles::ParticleView<dim>&, Stencil<dim, Basis>, const double*, Increments&);       \
  template Drift gather_increments_and_move<dim, Basis>(                                           \
      const particles::ParticleView<dim>&, Stencil<dim, Basis>, const AdvanceTimes&,               \
      const VelocityAcceleration<dim>&, const NodalVector<dim>&, const grid::Grid<dim>&,           \
      Increments&);
#define MPM_INSTANTIATE_FOR_DIMENSION(dim)   \
  template struct MassMomentumForce<dim>;    \
  template struct VelocityAcceleration<dim>; \
  template struct NodalVector<dim>;          \
  template void rotate_and_expand<dim>(const particles::ParticleView<dim>&, const Increments&);

MPM_INSTANTIATE_FOR_DIMENSION(1)
MPM_INSTANTIATE_FOR_DIMENSION(2)
MPM_INSTANTIATE_FOR_DIMENSION(3)
MPM_BASES(MPM_IN_ALL_DIMENSIONS)

}  // namespace mpm::transfer
