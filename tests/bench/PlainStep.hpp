#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

// The yardstick of tools/bench: the material point method as a textbook writes it, for one core.
// Cubic B-splines on a uniform grid, MUSL, a linear elastic block in empty space. Structs of a
// particle and of a node, weights by formula wherever they are needed, scalar code. Stands on the
// standard library alone, so that nothing done to the solver makes it faster.

namespace mpm::bench {

/// A block of cells full of particles in a grid that is a few cells wider on every side; all units
/// SI.
struct Block {
  int cells = 106;  ///< along a side of the block
  int margin = 4;   ///< empty cells on every side
  int particles_per_direction = 2;
  double cell = 0.01;  ///< m
  double youngs_modulus = 2e6, poisson_ratio = 0.3, density = 1300.0;
  double speed = 0.005;  ///< m/s, the largest at the start: slow enough to stay in the grid
  double courant = 0.9;  ///< share of h/(c + |v|)
  double gravity = 0.0;  ///< m/s^2, against the last direction

  double lambda() const {
    return youngs_modulus * poisson_ratio / ((1.0 + poisson_ratio) * (1.0 - 2.0 * poisson_ratio));
  }
  double shear_modulus() const { return 0.5 * youngs_modulus / (1.0 + poisson_ratio); }
  double wave_speed() const { return std::sqrt((lambda() + 2.0 * shear_modulus()) / density); }
  double time_step() const { return courant * cell / (wave_speed() + speed); }

  /// Velocity at the start: waves across the block, one direction into the next.
  template <std::size_t dim>
  std::array<double, dim> velocity(const std::array<double, dim>& x) const {
    std::array<double, dim> v;
    const double wave_number = 6.0 / (cells * cell);
    for (std::size_t d = 0; d < dim; ++d)
      v[d] = speed / std::sqrt(static_cast<double>(dim)) *
             std::sin(wave_number * x[(d + 1) % dim] + static_cast<double>(d));
    return v;
  }
};

template <std::size_t dim>
class PlainBody {
 public:
  using Vector = std::array<double, dim>;
  using Matrix = std::array<Vector, dim>;

  struct Particle {
    Vector x, v{}, displacement{};
    double m, V;
    Matrix stress{};
    double stress_out_of_plane = 0.0;
  };

  /// Particles cell by cell, first direction fastest among cells and within them.
  explicit PlainBody(const Block& block)
      : m_block(block), m_points(block.cells + 2 * block.margin + 3) {
    std::size_t nodes = 1;
    for (std::size_t d = 0; d < dim; ++d) nodes *= static_cast<std::size_t>(m_points);
    m_nodes.resize(nodes);
    const int n = block.particles_per_direction;
    for (int cell = 0; cell < power(block.cells); ++cell)
      for (int k = 0; k < power(n); ++k) add_particle(digits(cell, block.cells), digits(k, n));
  }

  const std::vector<Particle>& particles() const { return m_particles; }

  /// Momenta change over `momentum_dt`, which is half of dt in the first step.
  void step(double momentum_dt, double dt) {
    clear_nodes();
    deposit();
    update_nodes(momentum_dt);
    update_velocities_and_deposit(momentum_dt);
    find_remapped_velocities();
    strain_and_move(dt);
  }

  Vector momentum() const {
    Vector sum{};
    for (const Particle& particle : m_particles)
      for (std::size_t d = 0; d < dim; ++d) sum[d] += particle.m * particle.v[d];
    return sum;
  }
  double mass() const {
    double sum = 0.0;
    for (const Particle& particle : m_particles) sum += particle.m;
    return sum;
  }

 private:
  struct Node {
    double m;
    Vector momentum, force, v, a;
  };

  struct Weights {
    std::array<int, dim> first;
    std::array<std::array<double, 4>, dim> N, dN;
  };

  static int power(int base) {
    int result = 1;
    for (std::size_t d = 0; d < dim; ++d) result *= base;
    return result;
  }
  static std::array<int, dim> digits(int number, int base) {
    std::array<int, dim> result;
    for (std::size_t d = 0; d < dim; ++d, number /= base) result[d] = number % base;
    return result;
  }

  void add_particle(const std::array<int, dim>& cell, const std::array<int, dim>& place) {
    Particle particle;
    const double h = m_block.cell, n = m_block.particles_per_direction;
    particle.V = 1.0;
    for (std::size_t d = 0; d < dim; ++d) {
      particle.x[d] = h * (cell[d] + (place[d] + 0.5) / n);
      particle.V *= h / n;
    }
    particle.m = m_block.density * particle.V;
    particle.v = m_block.velocity<dim>(particle.x);
    m_particles.push_back(particle);
  }

  Weights weights(const Vector& x) const {
    Weights w;
    for (std::size_t d = 0; d < dim; ++d) {
      const double inverse = 1.0 / m_block.cell;
      const double place = x[d] * inverse + m_block.margin;
      w.first[d] = static_cast<int>(place);
      const double t = place - w.first[d], s = 1.0 - t;
      w.N[d] = {s * s * s / 6.0, (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0, t * t * t / 6.0};
      w.dN[d] = {-0.5 * s * s * inverse, (1.5 * t * t - 2.0 * t) * inverse,
                 (2.0 * s - 1.5 * s * s) * inverse, 0.5 * t * t * inverse};
    }
    return w;
  }

  /// visit(node, N, gradient of N)
  template <class Visit>
  void for_each_node(const Weights& w, const Visit& visit) {
    if constexpr (dim == 2) {
      for (std::size_t j = 0; j < 4; ++j)
        for (std::size_t i = 0; i < 4; ++i) {
          const auto node = static_cast<std::size_t>(w.first[1]) + j;
          const auto index =
              node * static_cast<std::size_t>(m_points) + static_cast<std::size_t>(w.first[0]) + i;
          visit(m_nodes[index], w.N[0][i] * w.N[1][j],
                Vector{w.dN[0][i] * w.N[1][j], w.N[0][i] * w.dN[1][j]});
        }
    } else {
      for (std::size_t k = 0; k < 4; ++k)
        for (std::size_t j = 0; j < 4; ++j)
          for (std::size_t i = 0; i < 4; ++i) {
            const auto points = static_cast<std::size_t>(m_points);
            const auto row = (static_cast<std::size_t>(w.first[2]) + k) * points +
                             static_cast<std::size_t>(w.first[1]) + j;
            visit(m_nodes[row * points + static_cast<std::size_t>(w.first[0]) + i],
                  w.N[0][i] * w.N[1][j] * w.N[2][k],
                  Vector{w.dN[0][i] * w.N[1][j] * w.N[2][k], w.N[0][i] * w.dN[1][j] * w.N[2][k],
                         w.N[0][i] * w.N[1][j] * w.dN[2][k]});
          }
    }
  }

  void clear_nodes() {
    for (Node& node : m_nodes) node = Node{};
  }

  /// m_I = sum m_p N, p_I = sum m_p v_p N, f_I = sum (m_p g N - V_p sigma_p grad N).
  void deposit() {
    for (const Particle& particle : m_particles) {
      for_each_node(weights(particle.x), [&](Node& node, double N, const Vector& gradient) {
        node.m += particle.m * N;
        for (std::size_t i = 0; i < dim; ++i) {
          double f = 0.0;
          for (std::size_t j = 0; j < dim; ++j) f -= particle.stress[i][j] * gradient[j];
          node.momentum[i] += particle.m * particle.v[i] * N;
          node.force[i] += particle.V * f;
        }
        node.force[dim - 1] -= particle.m * m_block.gravity * N;
      });
    }
  }

  void update_nodes(double dt) {
    for (Node& node : m_nodes) {
      const double inverse = node.m > 0.0 ? 1.0 / node.m : 0.0;
      for (std::size_t d = 0; d < dim; ++d) {
        node.momentum[d] += node.force[d] * dt;
        node.v[d] = node.momentum[d] * inverse;
        node.a[d] = node.force[d] * inverse;
        node.momentum[d] = 0.0;
      }
    }
  }

  /// v_p += dt sum a_I N, then p_I = sum m_p v_p N.
  void update_velocities_and_deposit(double dt) {
    for (Particle& particle : m_particles) {
      const Weights w = weights(particle.x);
      for_each_node(w, [&](const Node& node, double N, const Vector&) {
        for (std::size_t d = 0; d < dim; ++d) particle.v[d] += node.a[d] * N * dt;
      });
      for_each_node(w, [&](Node& node, double N, const Vector&) {
        for (std::size_t d = 0; d < dim; ++d) node.momentum[d] += particle.m * particle.v[d] * N;
      });
    }
  }

  void find_remapped_velocities() {
    for (Node& node : m_nodes) {
      const double inverse = node.m > 0.0 ? 1.0 / node.m : 0.0;
      for (std::size_t d = 0; d < dim; ++d) node.momentum[d] *= inverse;
    }
  }

  /// Moves with the nodes' velocities, strains with the remapped ones.
  void strain_and_move(double dt) {
    for (Particle& particle : m_particles) {
      Vector v{};
      Matrix L{};
      for_each_node(weights(particle.x), [&](const Node& node, double N, const Vector& gradient) {
        for (std::size_t i = 0; i < dim; ++i) {
          v[i] += node.v[i] * N;
          for (std::size_t j = 0; j < dim; ++j) L[i][j] += node.momentum[i] * gradient[j];
        }
      });
      for (std::size_t d = 0; d < dim; ++d) {
        particle.x[d] += v[d] * dt;
        particle.displacement[d] += v[d] * dt;
      }
      update_stress(particle, L, dt);
    }
  }

  /// Turns the stress by the spin (Hughes and Winget) and adds that of the strain.
  void update_stress(Particle& particle, const Matrix& L, double dt) const {
    Matrix strain, W;
    double volumetric = 0.0, square = 0.0;
    for (std::size_t i = 0; i < dim; ++i) {
      for (std::size_t j = 0; j < dim; ++j) {
        strain[i][j] = 0.5 * (L[i][j] + L[j][i]) * dt;
        W[i][j] = 0.5 * (L[i][j] - L[j][i]) * dt;
        square += 0.5 * W[i][j] * W[i][j];
      }
      volumetric += strain[i][i];
    }
    const Matrix WW = product(W, W);
    Matrix Q;
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t j = 0; j < dim; ++j)
        Q[i][j] = (i == j ? 1.0 : 0.0) + (W[i][j] + 0.5 * WW[i][j]) / (1.0 + 0.25 * square);
    const Matrix turned = product(Q, product(particle.stress, transposed(Q)));
    const double lambda = m_block.lambda(), mu = m_block.shear_modulus();
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t j = 0; j < dim; ++j)
        particle.stress[i][j] =
            turned[i][j] + 2.0 * mu * strain[i][j] + (i == j ? lambda * volumetric : 0.0);
    particle.stress_out_of_plane += lambda * volumetric;
    particle.V *= std::exp(volumetric);
  }

  static Matrix product(const Matrix& a, const Matrix& b) {
    Matrix c{};
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t j = 0; j < dim; ++j)
        for (std::size_t k = 0; k < dim; ++k) c[i][j] += a[i][k] * b[k][j];
    return c;
  }
  static Matrix transposed(const Matrix& a) {
    Matrix c;
    for (std::size_t i = 0; i < dim; ++i)
      for (std::size_t j = 0; j < dim; ++j) c[i][j] = a[j][i];
    return c;
  }

  Block m_block;
  int m_points;  ///< nodes per direction
  std::vector<Node> m_nodes;
  std::vector<Particle> m_particles;
};

}  // namespace mpm::bench
