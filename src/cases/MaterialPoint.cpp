#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "mpm/cases/Case.hpp"
#include "mpm/io/TextFile.hpp"
#include "mpm/material/ElementTest.hpp"
#include "mpm/material/LoadingPath.hpp"
#include "mpm/material/SandFactory.hpp"

namespace mpm::cases {
namespace {

using material::ElementTestKind;
using material::ElementTestRow;

/// A law of the table with its options and the names of these.
struct Law {
  std::string name;
  std::unique_ptr<material::MaterialFactory> factory;
  std::vector<std::string> options;
};

std::vector<Law> laws() {
  std::vector<Law> made;
  for (const material::MaterialKind& kind : material::material_kinds()) {
    made.push_back({std::string(kind.name), kind.make_factory(), {}});
    if (auto* sand = dynamic_cast<material::SandFactory*>(made.back().factory.get())) {
      sand->parameters().cohesion = 0.0;
      sand->parameters().void_ratio = 0.551;
    }
  }
  return made;
}

bool has_void_ratio(const material::Material& law) {
  return std::ranges::any_of(law.state_variables(),
                             [](const auto& variable) { return variable.name == "void_ratio"; });
}

/// Element tests of one material: one point, no grid.
class MaterialPoint : public Case {
 public:
  void declare(options::OptionSet& options) override {
    m_options = &options;
    options.section("Test");
    options.path("output_dir", m_directory,
                 {"", "directory of all results, made if missing", "chosen"});
    declare_test(options);
    declare_material(options);
  }

  const std::string& output_directory() const override { return m_directory; }

  void prepare() override {
    refuse_options_without_effect();
    m_settings.increments = static_cast<std::size_t>(m_increments);
    if (m_settings.kind == ElementTestKind::path)
      m_settings.path = material::read_path_file(m_path_file);
    m_tested = m_laws[m_law].factory->create();
  }

  void run(io::Summary& summary) override {
    const material::Material& law = *m_tested;
    const std::vector<ElementTestRow> rows = run_element_test(law, m_settings);
    write(rows);
    summarise(rows, summary);
    if (has_void_ratio(law)) summary.set("void_ratio_end", rows.back().void_ratio);
  }

  std::string answer(const io::Summary& summary) const override {
    return fmt::format("peak q {:.4g} kPa at strain {:.3g}, q at the end {:.4g} kPa",
                       summary.number("q_peak_Pa") / 1e3, summary.number("strain_at_peak"),
                       summary.number("q_end_Pa") / 1e3);
  }

 private:
  void declare_test(options::OptionSet& options) {
    options.choice("test", m_settings.kind,
                   {{"triaxial_compression", ElementTestKind::triaxial_compression},
                    {"triaxial_extension", ElementTestKind::triaxial_extension},
                    {"plane_strain", ElementTestKind::plane_strain},
                    {"simple_shear_constant_volume", ElementTestKind::simple_shear_constant_volume},
                    {"oedometer", ElementTestKind::oedometer},
                    {"path", ElementTestKind::path}},
                   {"", "kind of element test; path follows -path_file", "paper, section 3.1"});
    options.real("confining_pressure", m_settings.confining_pressure, options::not_negative(),
                 {"Pa", "initial isotropic mean stress", "paper, section 3.1"});
    options.real("strain_end", m_settings.strain_end,
                 {.minimum = 0.0, .maximum = 5.0, .open_minimum = true},
                 {"1",
                  "size of the last axial strain (engineering shear strain in simple shear), "
                  "logarithmic",
                  "chosen"});
    options.integer("increments", m_increments, {1, 10'000'000},
                    {"1", "rows of the result", "chosen"});
    options.input_file(
        "path_file", m_path_file,
        {"",
         "CSV file of -test path: legs under mixed strain and stress control, normal "
         "components compression positive, see docs/model.md",
         "chosen"});
  }

  void declare_material(options::OptionSet& options) {
    std::vector<std::pair<std::string, std::size_t>> names;
    for (std::size_t k = 0; k < m_laws.size(); ++k) names.emplace_back(m_laws[k].name, k);
    options.choice("material", m_law, names, {"", "law that is tested", "chosen"});
    for (Law& law : m_laws) {
      const std::size_t before = options.values().size();
      law.factory->declare(options);
      const auto values = options.values();
      for (std::size_t k = before; k < values.size(); ++k) law.options.push_back(values[k].first);
    }
  }

  /// An option that the run would not read is a mistake of the user.
  void refuse_options_without_effect() const {
    const bool path = m_settings.kind == ElementTestKind::path;
    if (path && m_path_file.empty())
      refuse("test", "needs -path_file", "a CSV file of legs", "add -path_file FILE");
    if (!path)
      refuse_if_changed("path_file", "is read by -test path only", "with -test path",
                        "leave it out or add -test path");
    for (const char* name : {"strain_end", "increments"})
      if (path)
        refuse_if_changed(name, "has no effect on -test path", "with the other tests",
                          "leave it out: the path file has strains and increments");
    for (const Law& law : m_laws)
      for (const std::string& name : law.options)
        if (law.name != m_laws[m_law].name)
          refuse_if_changed(name, "has no effect on -material " + m_laws[m_law].name,
                            "with -material " + law.name,
                            "leave it out or choose -material " + law.name);
  }

  void refuse_if_changed(const std::string& name, const std::string& fault,
                         const std::string& allowed, const std::string& remedy) const {
    if (m_options->is_changed(name)) refuse(name, fault, allowed, remedy);
  }

  [[noreturn]] void refuse(const std::string& name, const std::string& fault,
                           const std::string& allowed, const std::string& remedy) const {
    throw options::bad_input({m_options->given(name), fault, allowed, remedy});
  }

  void write(const std::vector<ElementTestRow>& rows) const {
    io::CsvFile history(m_directory + "/history.csv",
                        {"axial_strain", "q_Pa", "p_Pa", "volumetric_strain", "void_ratio",
                         "lode_angle_deg", "stress_xx_Pa", "stress_yy_Pa", "stress_zz_Pa",
                         "stress_xy_Pa", "stress_yz_Pa", "stress_xz_Pa", "strain_xx", "strain_yy",
                         "strain_zz", "gamma_xy", "gamma_yz", "gamma_xz"});
    for (const ElementTestRow& row : rows) {
      std::vector<double> values{row.axial_strain,      row.q,          row.p,
                                 row.volumetric_strain, row.void_ratio, row.lode_angle_deg};
      for (int k = 0; k < 6; ++k) values.push_back(k < 3 ? 0.0 - row.stress[k] : row.stress[k]);
      for (int k = 0; k < 6; ++k)
        values.push_back(k < 3 ? 0.0 - row.strain[k] : 2.0 * row.strain[k]);
      history.row(values);
    }
  }

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
    summary.set("volumetric_strain_end", rows.back().volumetric_strain);
  }

  const options::OptionSet* m_options = nullptr;
  std::string m_directory = "out/material_point";
  material::ElementTestSettings m_settings;
  std::int64_t m_increments = 150;
  std::string m_path_file;
  std::vector<Law> m_laws = laws();
  std::size_t m_law = 0;
  std::unique_ptr<material::Material> m_tested;
};

}  // namespace

std::unique_ptr<Case> make_material_point() {
  return std::make_unique<MaterialPoint>();
}

}  // namespace mpm::cases
