#include "CustomOptions.hpp"

#include <fmt/format.h>

#include "Lists.hpp"
#include "mpm/cases/Evidence.hpp"
#include "mpm/options/TableChoice.hpp"

namespace mpm::cases::custom {
namespace {

/// Declares a list of names and, once they are known, the options of the thing of each name.
template <class Thing>
void declare_named(options::OptionSet& set, const std::string& kind,
                   std::vector<std::string>& names, Named<Thing>& things, options::About about) {
  const std::string list = kind == "body" ? "bodies" : kind + "s";
  set.names(list, names, std::move(about));
  const auto declare = [&set, &things, kind](const std::string& name) {
    set.section(fmt::format("{} {}", kind, name));
    Thing& thing = *things.emplace_back(std::make_unique<Thing>());
    thing.name = name;
    set.prefixed(fmt::format("{}_{}_", kind, name), [&] { thing.declare(set); });
  };
  set.opens(
      [&names, declare] {
        for (const std::string& name : names) declare(name);
      },
      [declare] { declare("NAME"); });
}

}  // namespace

void RegionOptions::declare(options::OptionSet& set) {
  shape.declare(set);
  set.real("K0", K0, options::between(0.0, 10.0),
           {"1", "horizontal over vertical stress at rest, which is the weight above", "chosen"});
  set.real_list(
      "stress", stress, {},
      {"Pa", "xx,yy,zz,xy at the start, tension positive, in place of that at rest", "chosen"});
  law.declare(set);
}

void BodyOptions::declare(options::OptionSet& set) {
  shape.declare(set);
  set.real_list("velocity", velocity, {},
                {"m/s", "one component a dimension; without it the body stands still", "chosen"});
  set.real("ramp", ramp, options::not_negative(),
           {"m", "way over which the velocity rises as (1 - cos)/2", "chosen"});
  set.input_file(
      "motion", motion,
      {"",
       "file of time, velocity components and, in the plane, spin (rad/s, anticlockwise); "
       "linear in time between its rows",
       "chosen"});
  set.real("friction", friction, options::not_negative(),
           {"1", "Coulomb coefficient mu", "chosen"});
  set.choice(
      "friction_law", friction_law, options::rows_by_name(contact::friction_kinds()),
      {"", "friction by a coefficient, or nothing slides while it touches", "docs/model.md"});
  set.choice("detection", detection,
             {{"gap", contact::detection_named("gap")},
              {"particle", contact::detection_named("particle")},
              {"spring", contact::detection_named("spring")}},
             {"",
              "touching are nodes near it, of these those whose particles touch it, or particles "
              "whose own extent meets it",
              "docs/model.md"});
  set.real("gap_cells", gap_cells, {.minimum = 0.0, .maximum = 2.0},
           {"cells", "largest distance of a touching node", "docs/model.md"});
  set.real_list("contour", contour, options::not_negative(),
                {"m",
                 "distances from the body between which the second reaction is taken; empty is "
                 "1.5 and 5 cells",
                 "docs/custom.md"});
}

void LoadOptions::declare(options::OptionSet& set) {
  for (std::size_t side = 0; side < side_names.size(); ++side)
    set.optional_real(
        side_names[side], pressure[side], {}, "none",
        {"Pa", fmt::format("pressure on surfaces that face {}", side_names[side]), ""});
  set.real_list(
      "box", box, {},
      {"m", "lower and upper corner of where it acts at the start; empty is everywhere", "chosen"});
}

void StageOptions::declare(options::OptionSet& set) {
  set.text("until", until,
           {"", "its end: the word rest, a time in s, or BODY:DISTANCE in m that a body has moved",
            "", true});
  set.real("damping", damping, {.minimum = 0.0, .maximum = 1.0, .open_maximum = true},
           {"1", "local damping, f -= damping |f| sign(v)", "docs/model.md"});
  set.choice("bodies", bodies, {{"moving", Bodies::moving}, {"held", Bodies::held}},
             {"", "whether bodies move or stand still, the time of their motion too", "chosen"});
  set.choice("begins", begin,
             {{"auto", Begin::automatic},
              {"as_it_is", Begin::as_it_is},
              {"at_rest", Begin::at_rest},
              {"anew", Begin::anew}},
             {"",
              "with what the stage before left, with velocities, displacements and strains at "
              "zero, or with the clock at zero too; auto is anew after a stage that ended at rest",
              "chosen"});
  set.real("rest_tolerance", rest_tolerance, {.minimum = 1e-12, .maximum = 0.1},
           {"1", "at rest when sum |f| falls below this share of -rest_force", "docs/model.md"});
  set.optional_real("rest_force", rest_force, options::positive(), "the weight of the soil",
                    {"N", "force that the unbalanced ones are compared with", "chosen"});
}

CustomOptions::CustomOptions()
    : checks({{.name = "particles_in_body",
               .limits = {0.0, 0.01},
               .sentence = "share of the particles deeper in a body than half a cell",
               .remedy = "-body_NAME_detection spring, a slower motion or smaller cells may help"},
              limits_of_law()}) {
  run.output_dir = "out/custom";
}

void CustomOptions::declare(options::OptionSet& set) {
  run.declare(set);
  declare_space(set);
  declare_things(set);
  checks.declare(set);
}

void CustomOptions::declare_space(options::OptionSet& set) {
  set.section("Space");
  set.integer("dimension", dimension, {1, 3},
              {"1", "2 is plane strain; y is up, and x where there is no other", "chosen"});
  set.real_list("domain", domain, {},
                {"m", "lower and upper corner of the grid: x0,y0,x1,y1", "", true});
  set.optional_real("cell_size", cell_size, options::positive(), "as files of lines say",
                    {"m", "side of the cells, whole numbers of which fill the domain", ""});
  for (std::size_t d = 0; d < lines_files.size(); ++d)
    set.input_file(
        fmt::format("lines_{}", "xyz"[d]), lines_files[d],
        {"", "file of the positions of this direction's grid lines, in place of -cell_size",
         "chosen"});
  set.real_list("fine_box", fine_box, {},
                {"m",
                 "lower and upper corner of the part whose cells have -cell_size; beyond it each "
                 "is up to 5 % wider than the one before",
                 "chosen"});
  set.real("far_cell_ratio", far_cell_ratio, options::between(1.0, 100.0),
           {"1", "largest cells beyond -fine_box over -cell_size", "chosen"});
  set.text_list("walls", walls,
                {"",
                 "left,right,bottom,top (front,back): free, roller, symmetry or fixed each; soil "
                 "must not reach a free one",
                 "", true});
  set.real("gravity", gravity, options::not_negative(), {"m/s^2", "downward", "chosen"});
  set.real("gravity_angle", gravity_angle, options::between(-180.0, 180.0),
           {"degrees",
            "by which downward is turned anticlockwise in the plane of x and y, as on a slope or "
            "to see whether an answer feels the grid",
            "docs/custom.md"});
  set.rule([this, &set] {
    if (dimension > 1 || !set.is_changed("gravity_angle")) return;
    throw options::bad_input({set.given("gravity_angle"), "there is one direction only",
                              "only with -dimension 2 or 3", "leave it out"});
  });
}

void CustomOptions::declare_things(options::OptionSet& set) {
  set.section("What there is");
  declare_named(set, "region", region_names, regions,
                {"", "names of parts of the ground; later ones replace earlier ones", "", true});
  declare_named(set, "body", body_names, bodies, {"", "names of rigid bodies", "chosen"});
  declare_named(set, "load", load_names, loads, {"", "names of pressures on surfaces", "chosen"});
  declare_named(set, "stage", stage_names, stages, {"", "names of stages, in order", "chosen"});
  set.real_list("watch", watched, {},
                {"m", "x,y,x,y,... of points whose nearest particles are followed", "chosen"});
}

}  // namespace mpm::cases::custom
