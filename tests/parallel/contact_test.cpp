#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "mpm/contact/RigidContact.hpp"
#include "mpm/geometry/Ball.hpp"
#include "mpm/geometry/HalfSpace.hpp"
#include "mpm/petsc/Session.hpp"
#include "support/Grids.hpp"
#include "support/Scenes.hpp"

namespace mpm::contact {
namespace {

using basis::KnotLines;
using geometry::Ball;
using geometry::HalfSpace;
using geometry::Proximity;
using grid::Wall;

template <int dim>
double dot(const Vector<dim>& a, const Vector<dim>& b) {
  double sum = 0.0;
  for (int d = 0; d < dim; ++d) sum += a[d] * b[d];
  return sum;
}

template <int dim>
double length(const Vector<dim>& a) {
  return std::sqrt(dot<dim>(a, a));
}

// Surfaces --------------------------------------------------------------------------------------

TEST(Surface, circle_and_sphere_know_distance_and_outward_normal) {
  const Ball<2> circle(0.7);
  EXPECT_NEAR(circle.locate({0.9, -1.2}).distance, 1.5 - 0.7, 1e-15);
  EXPECT_NEAR(circle.locate({0.9, -1.2}).normal[0], 0.6, 1e-15);
  EXPECT_NEAR(circle.locate({0.9, -1.2}).normal[1], -0.8, 1e-15);
  EXPECT_NEAR(circle.locate({-0.3, 0.4}).distance, 0.5 - 0.7, 1e-15);
  EXPECT_NEAR(circle.locate({-0.3, 0.4}).normal[0], -0.6, 1e-15);
  const Ball<3> sphere(1.1);
  EXPECT_NEAR(sphere.locate({0.4, -0.8, 0.8}).distance, 1.2 - 1.1, 1e-15);
  EXPECT_NEAR(sphere.locate({0.4, -0.8, 0.8}).normal[1], -2.0 / 3.0, 1e-15);
}

TEST(Surface, at_its_centre_a_circle_still_has_a_unit_normal) {
  const Proximity<2> centre = Ball<2>(0.7).locate({0.0, 0.0});
  EXPECT_EQ(centre.distance, -0.7);
  EXPECT_EQ(length<2>(centre.normal), 1.0);
}

TEST(Surface, half_space_lies_behind_its_normal) {
  const HalfSpace<2> plane({0.6, 0.8});
  EXPECT_NEAR(plane.locate({1.0, 2.0}).distance, 2.2, 1e-15);
  EXPECT_NEAR(plane.locate({-1.0, -0.5}).distance, -1.0, 1e-15);
  EXPECT_EQ(plane.locate({-1.0, -0.5}).normal, (Vector<2>{0.6, 0.8}));
}

TEST(Surface, a_moved_body_takes_its_surface_with_it) {
  const RigidBody<2> body(std::make_shared<Ball<2>>(0.7), {2.0, -1.0});
  EXPECT_NEAR(body.locate({2.9, -2.2}).distance, 0.8, 1e-15);
  EXPECT_NEAR(body.locate({2.9, -2.2}).normal[1], -0.8, 1e-15);
}

// Single nodes ----------------------------------------------------------------------------------

constexpr double h = 0.1, density = 1300.0;

/// A grid with mass and momentum on its nodes, and a rigid body.
template <int dim>
struct Nodes {
  Nodes(const std::shared_ptr<RigidBody<dim>>& body, const ContactOptions& options)
      : contact(grid, walls, deposit, body, options) {
    grid.for_each_owned_node([&](int I, const auto&) { sums.values(0)[I] = m; });
  }

  void correct() {
    contact.find_nodes();
    transfer::MassMomentumForce<dim> slices(sums);
    grid::ConstrainedNodes<dim> nodes(slices.mass, slices.momentum, slices.force, dt);
    nodes.book_on(contact.booking());
    contact.constrain(grid, nodes);
  }
  Vector<dim> take_impulse() { return contact.body().meter().take_impulse(); }
  Vector<dim> momentum(int I) const { return at(1, I); }
  Vector<dim> force(int I) const { return at(1 + dim, I); }
  Vector<dim> at(int first, int I) const {
    Vector<dim> v;
    for (int d = 0; d < dim; ++d) v[d] = sums.values(first + d)[I];
    return v;
  }

  static constexpr double dt = 3e-3;
  const double m = density * std::pow(h, dim);
  std::array<test::Spline, dim> bases = test::splines<dim>([] {
    return [&]<std::size_t... d>(std::index_sequence<d...>) {
      return std::array<KnotLines, dim>{
          (static_cast<void>(d), KnotLines::uniform(0.0, 1.3, 13))...};
    }
    (std::make_index_sequence<static_cast<std::size_t>(dim)>{});
  }());
  std::array<basis::NodeLine, dim> lines = test::node_lines<dim>(bases);
  grid::Grid<dim> grid{test::world(), lines, test::uneven_layout<dim>(lines)};
  grid::Walls<dim> walls{test::walls_all<dim>(Wall::free)};
  transfer::BasisDeposit<dim, test::Spline> deposit{grid, bases};
  grid::NodalField<dim> sums{grid, transfer::MassMomentumForce<dim>::components()};
  RigidContact<dim> contact;
};

template <int dim>
Vector<dim> any_velocity(int I) {
  Vector<dim> v;
  for (int d = 0; d < dim; ++d) v[d] = 1.3 * std::sin(2.1 * I + 1.7 * d);
  return v;
}

/// What the law of contact asks for, for a velocity relative to the rigid body.
template <int dim>
Vector<dim> after_contact(Vector<dim> relative, const Vector<dim>& n, double mu) {
  const double closing = -dot<dim>(relative, n);
  if (closing <= 0.0) return relative;
  Vector<dim> t;
  for (int d = 0; d < dim; ++d) t[d] = relative[d] + closing * n[d];
  const double slip = length<dim>(t), rest = std::max(0.0, slip - mu * closing);
  for (int d = 0; d < dim; ++d) t[d] *= rest / slip;
  return t;
}

template <int dim>
void touching_nodes_obey_coulomb(const std::shared_ptr<RigidBody<dim>>& the_body, double mu) {
  const RigidBody<dim>& body = *the_body;
  Nodes<dim> nodes(the_body, {.gap_cells = 0.6, .friction = mu, .reference_density = density});
  const double m = nodes.m, dt = Nodes<dim>::dt;
  nodes.grid.for_each_owned_node([&](int I, const auto&) {
    const Vector<dim> v = any_velocity<dim>(I);
    for (int d = 0; d < dim; ++d) nodes.sums.values(1 + d)[I] = m * v[d];
  });
  nodes.correct();
  Vector<dim> impulse{};
  int stuck = 0, sliding = 0;
  nodes.grid.for_each_owned_node([&](int I, const auto& node) {
    const Proximity<dim> near = body.locate(nodes.grid.position(node));
    const Vector<dim> before = any_velocity<dim>(I);
    Vector<dim> expected = before, relative;
    for (int d = 0; d < dim; ++d) relative[d] = before[d] - body.velocity[d];
    const bool touches = near.distance <= 0.6 * h;
    const bool closes = touches && dot<dim>(relative, near.normal) < 0.0;
    if (closes) {
      const Vector<dim> after = after_contact<dim>(relative, near.normal, mu);
      for (int d = 0; d < dim; ++d) expected[d] = after[d] + body.velocity[d];
      ++(length<dim>(after) > 0.0 ? sliding : stuck);
    }
    EXPECT_EQ(nodes.contact.booking().has_acted_on(I), closes);
    for (int d = 0; d < dim; ++d) {
      EXPECT_NEAR(nodes.momentum(I)[d], m * expected[d], 1e-14 * m);
      EXPECT_NEAR(nodes.force(I)[d], m * (expected[d] - before[d]) / dt, 1e-14 * m / dt);
      impulse[d] -= m * (expected[d] - before[d]);
    }
  });
  EXPECT_GT(petsc::sum(static_cast<long long>(sliding)), 0);
  EXPECT_EQ(petsc::sum(static_cast<long long>(stuck)) > 0, mu > 0.0);
  const Vector<dim> taken = nodes.take_impulse();
  for (int d = 0; d < dim; ++d) EXPECT_NEAR(taken[d], impulse[d], 1e-12 * m);
  EXPECT_EQ(length<dim>(nodes.take_impulse()), 0.0);  // once only
}

TEST(Contact, touching_nodes_obey_coulomb_exactly) {
  for (double mu : {0.0, 0.43}) {
    touching_nodes_obey_coulomb<2>(
        test::rigid_body<2>(HalfSpace<2>({-0.28, 0.96}), {0.7, 0.62}, {0.2, -0.3}), mu);
    touching_nodes_obey_coulomb<2>(test::rigid_body<2>(Ball<2>(0.33), {0.61, 0.58}, {0.1, -0.4}),
                                   mu);
    touching_nodes_obey_coulomb<3>(
        test::rigid_body<3>(Ball<3>(0.41), {0.61, 0.58, 0.66}, {0.1, -0.4, 0.2}), mu);
  }
}

TEST(Contact, second_mapping_corrects_velocity_and_leaves_no_impulse) {
  const auto plane = test::rigid_body<2>(HalfSpace<2>({0.0, 1.0}), {0.0, 0.62}, {0.0, 0.25});
  Nodes<2> nodes(plane, {.friction = 0.43, .reference_density = density});
  transfer::MassMomentumForce<2> slices(nodes.sums);
  nodes.contact.find_nodes();
  grid::ConstrainedNodes<2> second(slices.mass, slices.momentum);
  second.book_on(nodes.contact.booking());
  nodes.contact.constrain(nodes.grid, second);  // at rest, the plane rises
  nodes.grid.for_each_owned_node([&](int I, const auto& node) {
    const bool touches = nodes.grid.position(node)[1] <= 0.62 + 0.06;
    EXPECT_NEAR(nodes.momentum(I)[1], touches ? 0.25 * nodes.m : 0.0, 1e-14 * nodes.m);
    EXPECT_EQ(nodes.force(I)[1], 0.0);
    EXPECT_FALSE(nodes.contact.booking().has_acted_on(I));
  });
  EXPECT_EQ(length<2>(nodes.take_impulse()), 0.0);
}

TEST(RigidBody, moves_and_turns_as_its_motion_says) {
  struct Turn : Motion<2> {
    BodyVelocity<2> at(double time) const override { return {{0.3, -0.2 * time}, 0.7}; }
  };
  RigidBody<2> body(std::make_shared<HalfSpace<2>>(Vector<2>{0.0, 1.0}), {1.0, 2.0},
                    std::make_shared<Turn>());
  body.stand_still();
  body.end_step(3.7, 3.7);
  EXPECT_EQ(body.position, (Vector<2>{1.0, 2.0}));
  body.begin_step(0.4);
  EXPECT_EQ(body.velocity, (Vector<2>{0.3, -0.2 * 0.2}));
  EXPECT_NEAR(body.velocity_at({0.5, -0.1})[0], 0.3 + 0.07, 1e-15);
  EXPECT_NEAR(body.velocity_at({0.5, -0.1})[1], -0.04 + 0.35, 1e-15);
  body.end_step(0.4, 0.4);
  EXPECT_NEAR(body.position[0], 1.12, 1e-15);
  EXPECT_NEAR(body.angle, 0.28, 1e-15);
  body.begin_step(0.2);
  EXPECT_EQ(body.velocity[1], -0.2 * 0.5) << "the time of the motion goes on";
  const Proximity<2> place = body.locate({1.12, 2.0 - 0.016 + 0.5});
  EXPECT_NEAR(place.distance, 0.5 * std::cos(0.28), 1e-14);
  EXPECT_NEAR(place.normal[0], -std::sin(0.28), 1e-15);
}

TEST(RigidBody, meter_gives_force_and_moment_over_its_own_time) {
  const auto plane = test::rigid_body<2>(HalfSpace<2>({0.0, 1.0}), {0.35, 0.62}, {0.0, 0.25});
  Nodes<2> nodes(plane, {.reference_density = density});
  nodes.correct();  // lifts the nodes at rest
  Vector<2> impulse{};
  double moment = 0.0;
  nodes.grid.for_each_owned_node([&](int I, const auto& node) {
    impulse[1] -= nodes.momentum(I)[1];
    moment -= (nodes.grid.position(node)[0] - 0.35) * nodes.momentum(I)[1];
  });
  plane->end_step(0.0, 0.4);
  plane->end_step(0.0, 0.1);
  const BodyForce<2> mean = plane->meter().take_mean();
  const double scale = std::abs(petsc::sum(impulse[1]));
  EXPECT_GT(scale, 0.0);
  EXPECT_NEAR(mean.force[1], petsc::sum(impulse[1]) / 0.5, 1e-13 * scale);
  EXPECT_NEAR(mean.moment, petsc::sum(moment) / 0.5, 1e-13 * scale);
  EXPECT_EQ(plane->meter().take_mean().force[1], 0.0);
}

TEST(Friction, a_rough_surface_lets_nothing_slide) {
  const auto law = make_friction<3>(1, {.coefficient = 0.2});
  const Vector<3> relative{0.3, -0.4, 1.2};
  EXPECT_EQ(friction_kinds()[1].name, "rough");
  EXPECT_EQ(law->velocity_change(relative, {0.0, 1.0, 0.0}), (Vector<3>{-0.3, 0.4, -1.2}));
}

TEST(Contact, nodes_with_next_to_no_mass_take_no_part) {
  const auto plane = test::rigid_body<2>(HalfSpace<2>({0.0, 1.0}), {0.0, 0.62}, {0.0, 0.25});
  for (double share : {0.9e-9, 1.1e-9}) {
    Nodes<2> nodes(plane, {.reference_density = density});
    nodes.grid.for_each_owned_node(
        [&](int I, const auto&) { nodes.sums.values(0)[I] = share * nodes.m; });
    nodes.correct();
    EXPECT_EQ(petsc::maximum(length<2>(nodes.take_impulse())) > 0.0, share > 1e-9);
  }
}

// Normals from the mass of the rigid body -------------------------------------------------------

/// Points on a square lattice inside a circle about its centre.
std::vector<Vector<2>> points_of_circle(double radius, double spacing) {
  std::vector<Vector<2>> points;
  const int n = static_cast<int>(radius / spacing) + 1;
  for (int j = -n; j < n; ++j)
    for (int i = -n; i < n; ++i) {
      const Vector<2> x{(i + 0.5) * spacing, (j + 0.5) * spacing};
      if (length<2>(x) < radius) points.push_back(x);
    }
  return points;
}

TEST(Contact, gradient_normals_of_a_circle_are_radial) {
  const double radius = 0.41, spacing = 0.25 * h;
  const auto circle = test::rigid_body<2>(Ball<2>(radius), {0.63, 0.67});
  Nodes<2> nodes(circle, {.detection = detection_named("gap"),
                          .normal = Normal::gradient,
                          .gap_cells = 0.6,
                          .reference_density = density});
  nodes.contact.discretise(points_of_circle(radius, spacing), spacing * spacing);
  nodes.grid.for_each_owned_node([&](int I, const auto& node) {
    const Proximity<2> near = circle->locate(nodes.grid.position(node));
    for (int d : {0, 1}) nodes.sums.values(1 + d)[I] = -nodes.m * near.normal[d];
  });
  nodes.correct();
  int count = 0;
  nodes.grid.for_each_owned_node([&](int I, const auto& node) {
    const Proximity<2> near = circle->locate(nodes.grid.position(node));
    if (std::abs(near.distance) > 0.6 * h) return;
    Vector<2> change = nodes.momentum(I);
    for (int d : {0, 1}) change[d] += nodes.m * near.normal[d];
    ++count;
    EXPECT_GT(dot<2>(change, near.normal) / length<2>(change),
              std::cos(4.0 * std::numbers::pi / 180));
  });
  EXPECT_GT(petsc::sum(static_cast<long long>(count)), 20);
}

// Blocks ----------------------------------------------------------------------------------------

constexpr double width = 0.6, height = 0.4;

/// A soft block above a plane at `plane`; its lower side is at y = 0.6.
struct BlockOnPlane {
  BlockOnPlane(double plane_height, ContactOptions options, double gravity)
      : simulation(setup(gravity)) {
    options.reference_density = test::soft.density;
    const auto plane = test::rigid_body<2>(HalfSpace<2>({0.0, 1.0}), {0.0, plane_height});
    contact = std::make_shared<RigidContact<2>>(simulation.grid(), simulation.walls(),
                                                simulation.step().point_deposit(), plane, options);
    std::vector<Vector<2>> points;
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 28; ++i) points.push_back({(i + 0.5) * 0.5 * h, -(j + 0.5) * 0.5 * h});
    contact->discretise(points, 0.25 * h * h);
    simulation.add_constraint(contact);
  }

  static solver::SimulationSetup<2> setup(double gravity) {
    solver::SimulationSetup<2> setup{
        .lines = {KnotLines::uniform(0.0, 1.4, 14), KnotLines::uniform(0.0, 1.5, 15)}};
    setup.walls = test::walls_all<2>(Wall::free);
    setup.materials = {test::elastic(
        {.youngs_modulus = 3e5, .poisson_ratio = 0.25, .density = test::soft.density})};
    setup.filling = {[](const Vector<2>& x) {
                       const bool inside =
                           std::abs(x[0] - 0.7) < 0.5 * width && x[1] > 0.6 && x[1] < 0.6 + height;
                       return inside ? std::optional(0) : std::nullopt;
                     },
                     [](const auto&) { return 2; }};
    setup.gravity = {0.0, -gravity};
    setup.courant = 0.5;
    return setup;
  }

  /// Sum over the ranks.
  Vector<2> take_impulse() {
    Vector<2> impulse = contact->body().meter().take_impulse();
    for (double& component : impulse) component = petsc::sum(component);
    return impulse;
  }

  test::TimedSimulation<2> simulation;
  std::shared_ptr<RigidContact<2>> contact;
};

const std::array<ContactOptions, 3> all_kinds{
    ContactOptions{.detection = detection_named("gap"), .gap_cells = 0.6},
    ContactOptions{.detection = detection_named("velocity"), .normal = Normal::surface},
    ContactOptions{.detection = detection_named("velocity"), .normal = Normal::gradient}};

TEST(Contact, a_block_at_rest_presses_with_its_weight) {
  for (const ContactOptions& options : all_kinds) {
    const double gravity = 7.3;
    BlockOnPlane block(0.6, options, gravity);
    test::TimedSimulation<2>& simulation = block.simulation;
    simulation.set_damping(0.4);
    for (int k = 0; k < 3000; ++k) simulation.advance();
    block.take_impulse();
    double time = 0.0;
    for (int k = 0; k < 50; ++k) {
      const double dt_old = simulation.times.dt;
      simulation.advance();
      time += 0.5 * (dt_old + simulation.times.dt);
    }
    const Vector<2> impulse = block.take_impulse();
    const double weight = test::soft.density * width * height * gravity;
    EXPECT_NEAR(impulse[1] / time, -weight, 1e-4 * weight);
    EXPECT_NEAR(impulse[0] / time, 0.0, 1e-6 * weight);
  }
}

TEST(Contact, bodies_that_part_feel_nothing) {
  for (const ContactOptions& options : all_kinds) {
    BlockOnPlane block(0.63, options, 0.0);  // the plane reaches into the block
    test::set_velocity<2>(block.simulation, [](const auto&) { return Vector<2>{0.4, 0.02}; });
    for (int k = 0; k < 20; ++k) block.simulation.advance();
    EXPECT_EQ(block.take_impulse(), (Vector<2>{0.0, 0.0}));
  }
}

/// Gap at the first impulse, in cells, for a block that comes down on a plane.
double first_gap(const ContactOptions& options, double plane_height) {
  BlockOnPlane block(plane_height, options, 0.0);
  const double speed = 0.05;
  test::set_velocity<2>(block.simulation, [&](const auto&) { return Vector<2>{0.0, -speed}; });
  while (block.take_impulse()[1] == 0.0 && block.simulation.time() < 20.0) {
    block.simulation.advance(0.02 * h / speed);
  }
  return (0.6 - speed * block.simulation.time() - plane_height) / h;
}

/// The cubic splines of both bodies reach two cells: the velocity test finds them touching where
/// those meet. The gap test asks that the node lies near the surface, but the block still reaches
/// that node from two cells away.
TEST(Contact, velocity_detection_starts_a_cell_before_gap_detection_and_both_start_early) {
  for (double plane : {0.2, 0.225, 0.25, 0.275}) {
    const double gap = first_gap(all_kinds[0], plane);
    EXPECT_GT(gap, 1.0) << plane;
    EXPECT_LT(gap, 0.6 + 2.0) << plane;
    for (std::size_t k : {1u, 2u}) {
      EXPECT_NEAR(first_gap(all_kinds[k], plane) - gap, 1.0, 0.05) << plane;
      EXPECT_GT(first_gap(all_kinds[k], plane), 2.0) << plane;
    }
  }
}

TEST(Contact, gap_detection_comes_as_close_as_its_share_of_a_cell_allows) {
  ContactOptions touching = all_kinds[0];
  touching.gap_cells = 0.01;
  for (double plane : {0.245, 0.26, 0.28}) {
    EXPECT_LT(first_gap(touching, plane), 0.01 + 2.0) << plane;
    EXPECT_GT(first_gap(all_kinds[0], plane), first_gap(touching, plane)) << plane;
  }
}

}  // namespace
}  // namespace mpm::contact
