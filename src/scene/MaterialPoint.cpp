#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mpm/io/TextFile.hpp"
#include "mpm/material/ElementTest.hpp"
#include "mpm/material/SandFactory.hpp"
#include "mpm/scene/Scene.hpp"

namespace mpm::scene {
namespace {

using material::ElementTestKind;
using material::ElementTestRow;

/// Element tests of the sand law: one point, no grid.
class MaterialPoint : public Scene {
 public:
  MaterialPoint() {
    m_sand.parameters().cohesion = 0.0;
    m_sand.parameters().void_ratio = 0.551;
  }

  void declare(options::OptionSet& options) override {
    options.section("Test");
    options.text("output_dir", m_directory,
                 {"", "directory of all results, made if missing", "chosen"});
    options.choice("test", m_settings.kind,
                   {{"triaxial_compression", ElementTestKind::triaxial_compression},
                    {"triaxial_extension", ElementTestKind::triaxial_extension},
                    {"plane_strain", ElementTestKind::plane_strain},
                    {"simple_shear_constant_volume", ElementTestKind::simple_shear_constant_volume},
                    {"oedometer", ElementTestKind::oedometer}},
                   {"", "kind of element test", "paper, section 3.1"});
    options.real("confining_pressure", m_settings.confining_pressure, options::positive(),
                 {"Pa", "initial isotropic mean stress", "paper, section 3.1"});
    options.real("strain_end", m_settings.strain_end,
                 {.minimum = 0.0, .maximum = 5.0, .open_minimum = true},
                 {"1",
                  "size of the last axial strain (engineering shear strain in simple shear), "
                  "logarithmic",
                  "chosen"});
    options.integer("increments", m_increments, {1, 10'000'000},
                    {"1", "rows of the result", "chosen"});
    m_sand.declare(options);
  }

  const std::string& output_directory() const override { return m_directory; }

  void run(io::Summary& summary) override {
    m_settings.increments = static_cast<std::size_t>(m_increments);
    const auto law = m_sand.create();
    const std::vector<ElementTestRow> rows = run_element_test(*law, m_settings);
    io::CsvFile history(
        m_directory + "/history.csv",
        {"axial_strain", "q_Pa", "p_Pa", "volumetric_strain", "void_ratio", "lode_angle_deg"});
    for (const ElementTestRow& row : rows)
      history.row({row.axial_strain, row.q, row.p, row.volumetric_strain, row.void_ratio,
                   row.lode_angle_deg});
    summarise(rows, summary);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("peak q {:.4g} kPa at strain {:.3g}, q at the end {:.4g} kPa",
                       summary.number("q_peak_Pa") / 1e3, summary.number("strain_at_peak"),
                       summary.number("q_end_Pa") / 1e3);
  }

 private:
  static void summarise(const std::vector<ElementTestRow>& rows, io::Summary& summary) {
    const auto peak = std::max_element(rows.begin(), rows.end(),
                                       [](const auto& a, const auto& b) { return a.q < b.q; });
    summary.set("ranks", 1);
    summary.set("steps", rows.size() - 1);
    summary.set("q_peak_Pa", peak->q);
    summary.set("p_at_peak_Pa", peak->p);
    summary.set("strain_at_peak", peak->axial_strain);
    summary.set("q_end_Pa", rows.back().q);
    summary.set("p_end_Pa", rows.back().p);
    summary.set("void_ratio_end", rows.back().void_ratio);
    summary.set("volumetric_strain_end", rows.back().volumetric_strain);
  }

  std::string m_directory = "out/material_point";
  material::ElementTestSettings m_settings;
  std::int64_t m_increments = 150;
  material::SandFactory m_sand;
};

}  // namespace

std::unique_ptr<Scene> make_material_point() {
  return std::make_unique<MaterialPoint>();
}

}  // namespace mpm::scene
