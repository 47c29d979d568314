#pragma once

#include "CustomOptions.hpp"
#include "mpm/contact/ContourReaction.hpp"

namespace mpm::cases::custom {

/// A rigid body and what the options say about it.
template <int dim>
struct Body {
  std::string name;
  std::shared_ptr<contact::RigidBody<dim>> rigid;
  Vector<dim> start;  ///< of its reference point, m
  bool moves = false;
  contact::ContactOptions contact;
  contact::ContourBand contour;
};

/// `cell` is the smallest width of a cell, m. Throws BadInput where options make no sense together.
template <int dim>
std::vector<Body<dim>> bodies_of(const CustomOptions& options, double cell);

}  // namespace mpm::cases::custom
