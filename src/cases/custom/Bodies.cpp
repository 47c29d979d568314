#include "Bodies.hpp"

#include <cmath>

#include "Lists.hpp"
#include "mpm/contact/TableMotion.hpp"

namespace mpm::cases::custom {
namespace {

constexpr double contour_begin = 1.5;  // cells from the body
constexpr double contour_end = 5.0;

std::string option(const BodyOptions& body, const char* name) {
  return fmt::format("body_{}_{}", body.name, name);
}

void check_together(const BodyOptions& body) {
  const auto refuse = [&](const char* name, const char* why) {
    throw BadInput(fmt::format("-{} {}", option(body, name), why));
  };
  if (!body.velocity.empty() && !body.motion.empty())
    refuse("motion", "is given beside a velocity; leave one of them out");
  if (body.ramp > 0.0 && body.velocity.empty())
    refuse("ramp", "has no effect without a velocity; leave it out");
  const bool uses_coefficient = contact::friction_kinds()[body.friction_law].name == "coulomb";
  if (body.friction > 0.0 && !uses_coefficient)
    refuse("friction", "has no effect with this law of friction; leave one of them out");
}

template <int dim>
std::shared_ptr<const contact::Motion<dim>> motion_of(const BodyOptions& body) {
  if (!body.motion.empty())
    return std::make_shared<contact::TableMotion<dim>>(
        contact::read_motion<dim>(option(body, "motion"), body.motion));
  if (body.velocity.empty()) return nullptr;
  need_numbers(option(body, "velocity"), body.velocity, dim);
  Vector<dim> direction = vector_from<dim>(body.velocity);
  double square = 0.0;
  for (const double component : direction) square += component * component;
  if (square == 0.0) return nullptr;
  const double speed = std::sqrt(square);
  for (double& component : direction) component /= speed;
  return std::make_shared<contact::RampMotion<dim>>(direction, contact::Ramp{speed, body.ramp});
}

contact::ContourBand contour_of(const BodyOptions& body, double cell) {
  if (body.contour.empty()) return {.inner = contour_begin * cell, .outer = contour_end * cell};
  need_numbers(option(body, "contour"), body.contour, 2);
  if (!(body.contour[0] < body.contour[1]))
    throw BadInput(fmt::format("-{} {}: its beginning is not nearer than its end",
                               option(body, "contour"), fmt::join(body.contour, ",")));
  return {.inner = body.contour[0], .outer = body.contour[1]};
}

template <int dim>
Body<dim> make_body(const BodyOptions& options, double cell) {
  check_together(options);
  const auto shape = options.shape.create<dim>();
  const Vector<dim> start = shape->reference();
  Vector<dim> back;
  for (int d = 0; d < dim; ++d) back[d] = 0.0 - start[d];
  const auto motion = motion_of<dim>(options);
  return {.name = options.name,
          .rigid = std::make_shared<contact::RigidBody<dim>>(shape->moved(back), start, motion),
          .start = start,
          .moves = motion != nullptr,
          .contact = {.detection = options.detection,
                      .gap_cells = options.gap_cells,
                      .friction = options.friction,
                      .friction_law = options.friction_law,
                      .label = "body_" + options.name},
          .contour = contour_of(options, cell)};
}

}  // namespace

template <int dim>
std::vector<Body<dim>> bodies_of(const CustomOptions& options, double cell) {
  std::vector<Body<dim>> bodies;
  for (const auto& one : options.bodies) bodies.push_back(make_body<dim>(*one, cell));
  return bodies;
}

template std::vector<Body<1>> bodies_of<1>(const CustomOptions&, double);
template std::vector<Body<2>> bodies_of<2>(const CustomOptions&, double);
template std::vector<Body<3>> bodies_of<3>(const CustomOptions&, double);

}  // namespace mpm::cases::custom
