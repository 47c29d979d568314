#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

#include "mpm/options/CommandLine.hpp"
#include "mpm/options/Nearest.hpp"
#include "mpm/options/OptionSet.hpp"

namespace mpm::options {
namespace {

enum class Basis { linear, quadratic, cubic };

/// One option of every kind.
struct Sample {
  double courant = 0.4;
  double void_ratio = 0.55;
  double embedment = 3.0;
  double c = 0.75;
  double pressure = 2.5e5;
  std::int64_t cells = 8;
  std::string scene;
  std::string directory = "out/pipe";
  bool half = false;
  std::vector<double> times{0.1, 0.25};
  std::optional<double> friction;
  Basis basis = Basis::quadratic;
  OptionSet options;

  Sample() {
    options.section("Run");
    options.text("scene", scene,
                 {.unit = "", .sentence = "What to run.", .source = "", .required = true});
    options.text("output_dir", directory, {"", "Directory of the results.", "chosen"});
    options.choice(
        "basis", basis,
        {{"linear", Basis::linear}, {"quadratic", Basis::quadratic}, {"cubic", Basis::cubic}},
        {"", "Shape functions on the knot lines.", "Section 2"});
    options.real("courant", courant, {.minimum = 0.0, .maximum = 2.0, .open_minimum = true},
                 {"1", "Share of the largest stable step.", "chosen"});
    options.real_list("particle_output_times", times, not_negative(),
                      {"s", "When particles are written.", "chosen"});
    options.section("Pipe");
    options.real("sand_void_ratio", void_ratio, between(0.2, 2.0),
                 {"1", "Void ratio at the start.", "Table 1"});
    options.real("pipe_embedment_ratio", embedment, {.minimum = 1.0},
                 {"1", "Depth of the axis over the diameter.", "Table 2"});
    options.real("sand_c", c, {.minimum = 0.25, .maximum = 1.0, .open_maximum = true},
                 {"1", "Extension over compression strength.", "Table 1"});
    options.real("confining_pressure", pressure, positive(),
                 {"Pa", "Pressure at the start.", "Table 3"});
    options.integer("pipe_cells_per_diameter", cells, at_least(1),
                    {"1", "Cells across the pipe.", "chosen"});
    options.flag("half", half, {"", "Whether half of the domain is enough.", "chosen"});
    options.optional_real("contact_friction", friction, not_negative(), "tan(0.6 phi_c)",
                          {"1", "Friction of the pipe.", "Eq. 12"});
  }

  void assign(std::vector<Given> given) {
    given.insert(given.begin(), {"scene", "pipe", "command line"});
    options.assign(given);
  }
  void assign(const std::string& name, const std::string& value) {
    assign({{name, value, "input/pipe.opts:12"}});
  }
};

::testing::AssertionResult says(const std::string& text, const std::vector<std::string>& parts) {
  for (const std::string& part : parts)
    if (text.find(part) == std::string::npos)
      return ::testing::AssertionFailure() << "'" << part << "' is not in:\n" << text;
  return ::testing::AssertionSuccess();
}

template <class Action>
std::string refusal_of(Action action) {
  try {
    action();
  } catch (const BadInput& error) {
    return error.what();
  }
  return "no BadInput";
}

std::string refusal(const std::string& name, const std::string& value) {
  Sample sample;
  return refusal_of([&] { sample.assign(name, value); });
}

std::string without_line_ends(std::string text) {
  std::erase(text, '\n');
  return text;
}

CommandLine parse(const std::vector<const char*>& arguments) {
  return read_command_line(arguments);
}

std::string parse_refusal(const std::vector<const char*>& arguments) {
  return refusal_of([&] { parse(arguments); });
}

/// A directory with blanks in its name that goes away with the test.
class OptionsFile : public ::testing::Test {
 protected:
  OptionsFile() { std::filesystem::create_directories(m_directory); }
  ~OptionsFile() override { std::filesystem::remove_all(m_directory); }

  std::string path(const std::string& name) const { return (m_directory / name).string(); }

  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
    return path(name);
  }

  std::string refusal_of_text(const std::string& text) const {
    const std::string file = write("bad.opts", text);
    return parse_refusal({"-options_file", file.c_str()});
  }

 private:
  const std::filesystem::path m_directory =
      std::filesystem::temp_directory_path() /
      ("options test " + std::to_string(::getpid()) +
       ::testing::UnitTest::GetInstance()->current_test_info()->name());
};

const Given* find(const std::vector<Given>& all, const std::string& name) {
  const auto found = std::ranges::find(all, name, &Given::name);
  return found == all.end() ? nullptr : &*found;
}

// ---------------------------------------------------------------- values

TEST(Options, given_values_of_every_kind_replace_the_defaults) {
  Sample sample;
  sample.assign({{"courant", "0.7", "command line"},
                 {"pipe_cells_per_diameter", "12", "command line"},
                 {"output_dir", "out/dense run", "command line"},
                 {"half", "true", "command line"},
                 {"particle_output_times", "0.5, 2,1e1", "command line"},
                 {"contact_friction", "0.35", "command line"},
                 {"basis", "cubic", "command line"}});
  EXPECT_EQ(sample.courant, 0.7);
  EXPECT_EQ(sample.cells, 12);
  EXPECT_EQ(sample.scene, "pipe");
  EXPECT_EQ(sample.directory, "out/dense run");
  EXPECT_TRUE(sample.half);
  EXPECT_EQ(sample.times, (std::vector{0.5, 2.0, 10.0}));
  EXPECT_EQ(sample.friction, 0.35);
  EXPECT_EQ(sample.basis, Basis::cubic);
}

TEST(Options, values_not_given_keep_their_defaults) {
  Sample sample;
  sample.assign("courant", "0.7");
  EXPECT_EQ(sample.cells, 8);
  EXPECT_EQ(sample.basis, Basis::quadratic);
  EXPECT_FALSE(sample.friction);
  EXPECT_FALSE(sample.half);
}

TEST(Options, a_bare_flag_is_true_and_a_flag_can_be_false) {
  Sample sample;
  sample.assign("half", "");
  EXPECT_TRUE(sample.half);
  sample.assign("half", "false");
  EXPECT_FALSE(sample.half);
}

TEST(Options, every_usual_notation_of_a_real_is_read) {
  for (const auto& [text, value] : std::vector<std::pair<std::string, double>>{
           {"2", 2.0}, {"+1.5", 1.5}, {".5", 0.5}, {"3.", 3.0}, {"2.5E5", 2.5e5}, {"4e-3", 4e-3}}) {
    Sample sample;
    sample.assign("confining_pressure", text);
    EXPECT_EQ(sample.pressure, value) << text;
  }
}

TEST(Options, the_largest_64_bit_integer_is_kept_exactly) {
  Sample sample;
  sample.assign("pipe_cells_per_diameter", "9223372036854775807");
  EXPECT_EQ(sample.cells, 9223372036854775807);
}

TEST(Options, the_word_auto_stands_for_the_default_of_a_number_that_has_none) {
  Sample sample;
  sample.friction = 0.4;
  sample.assign("contact_friction", "auto");
  EXPECT_FALSE(sample.friction);
}

TEST(Options, the_ends_of_a_closed_range_are_allowed) {
  Sample sample;
  sample.assign({{"sand_void_ratio", "0.2", "x"}, {"courant", "2", "x"}, {"sand_c", "0.25", "x"}});
  EXPECT_EQ(sample.void_ratio, 0.2);
  EXPECT_EQ(sample.courant, 2.0);
  EXPECT_EQ(sample.c, 0.25);
}

TEST(Options, given_tells_value_and_origin) {
  Sample sample;
  sample.assign("courant", "0.7");
  EXPECT_TRUE(sample.options.is_given("courant"));
  EXPECT_FALSE(sample.options.is_given("sand_c"));
  EXPECT_EQ(sample.options.given("courant").value, "0.7");
  EXPECT_EQ(sample.options.given("courant").origin, "input/pipe.opts:12");
  EXPECT_EQ(sample.options.given("sand_c").value, "0.75");
  EXPECT_EQ(sample.options.given("sand_c").origin, "default");
}

// ---------------------------------------------------------------- bad values

TEST(Options, a_message_has_option_value_origin_allowed_and_remedy) {
  EXPECT_EQ(refusal("confining_pressure", "-3"),
            "-confining_pressure -3 (input/pipe.opts:12) is out of range; allowed: real, > 0, in "
            "Pa; correct it, or leave it out for the default: 250000");
}

TEST(Options, values_out_of_range_are_refused_with_the_range) {
  EXPECT_TRUE(says(refusal("courant", "2.5"), {"-courant 2.5"}));
  EXPECT_TRUE(says(refusal("courant", "2.5"), {"allowed: real, > 0 and <= 2;"}));
  EXPECT_TRUE(says(refusal("courant", "0"), {"is out of range"}));
  EXPECT_TRUE(says(refusal("sand_void_ratio", "0.1999"), {"allowed: real, 0.2 to 2;"}));
  EXPECT_TRUE(says(refusal("pipe_embedment_ratio", "0.5"), {"allowed: real, >= 1;"}));
  EXPECT_TRUE(says(refusal("sand_c", "1"), {"allowed: real, >= 0.25 and < 1;"}));
  EXPECT_TRUE(says(refusal("confining_pressure", "0"), {"allowed: real, > 0, in Pa;"}));
  EXPECT_TRUE(says(refusal("pipe_cells_per_diameter", "-4"),
                   {"-pipe_cells_per_diameter -4", "integer, >= 1;"}));
  EXPECT_TRUE(says(refusal("contact_friction", "-0.1"),
                   {"allowed: real, >= 0 | auto;", "default: tan(0.6 phi_c)"}));
}

TEST(Options, what_is_not_finite_is_refused) {
  for (const std::string value : {"nan", "NaN", "-nan", "inf", "-inf", "+inf", "infinity"})
    EXPECT_TRUE(says(refusal("confining_pressure", value),
                     {"-confining_pressure " + value, "is not finite", "real, > 0"}))
        << value;
}

TEST(Options, what_is_not_a_real_number_is_refused) {
  for (const std::string value :
       {"abc", "0.5abc", "0.5,", "1e", "1d-3", "0x10", "--1", "+-1", "+", "1 2", "0,5"})
    EXPECT_TRUE(says(refusal("courant", value),
                     {"-courant " + value, "is not a real number", "> 0 and <= 2"}))
        << value;
}

TEST(Options, what_is_not_an_integer_is_refused) {
  for (const std::string value : {"8.0", "1e3", "eight", "8 9", "0x8", "8m"})
    EXPECT_TRUE(says(refusal("pipe_cells_per_diameter", value),
                     {"-pipe_cells_per_diameter " + value, "is not an integer", "integer, >= 1"}))
        << value;
}

TEST(Options, numbers_that_do_not_fit_are_refused) {
  EXPECT_TRUE(says(refusal("pipe_cells_per_diameter", "9223372036854775808"),
                   {"9223372036854775808", "does not fit in 64 bits", "integer, >= 1"}));
  EXPECT_TRUE(says(refusal("confining_pressure", "1e999"), {"does not fit in 64 bits"}));
}

TEST(Options, a_list_needs_numbers_between_its_commas) {
  EXPECT_TRUE(says(refusal("particle_output_times", "0.1,,0.3"),
                   {"-particle_output_times 0.1,,0.3", "entry ''", "is not a real number",
                    "allowed: reals separated by commas, >= 0, in s"}));
  EXPECT_TRUE(says(refusal("particle_output_times", "0.1,"), {"entry ''"}));
  EXPECT_TRUE(says(refusal("particle_output_times", "0.1,x"), {"entry 'x'"}));
  EXPECT_TRUE(says(refusal("particle_output_times", "0.1,-1"), {"entry '-1' that is out of"}));
  EXPECT_TRUE(says(refusal("particle_output_times", "0.1,nan"), {"is not finite"}));
  EXPECT_TRUE(says(refusal("particle_output_times", ""), {"needs a value"}));
}

TEST(Options, a_bad_list_leaves_the_values_alone) {
  Sample sample;
  EXPECT_THROW(sample.assign("particle_output_times", "0.7,x"), BadInput);
  EXPECT_EQ(sample.times, (std::vector{0.1, 0.25}));
}

TEST(Options, a_word_that_is_no_choice_names_the_choices_and_the_nearest) {
  EXPECT_TRUE(says(refusal("basis", "qadratic"), {"-basis qadratic", "the nearest is quadratic",
                                                  "allowed: linear | quadratic | cubic"}));
  EXPECT_TRUE(says(refusal("basis", "Cubic"), {"the nearest is cubic"}));
}

TEST(Options, a_flag_is_true_or_false_only) {
  for (const std::string value : {"yes", "1", "True", "on"})
    EXPECT_TRUE(says(refusal("half", value), {"-half " + value, "allowed: true | false"}));
}

TEST(Options, text_that_an_options_file_cannot_hold_is_refused) {
  EXPECT_TRUE(says(refusal("output_dir", "a\"b"), {"-output_dir a\"b", "double quote", "text"}));
  EXPECT_TRUE(says(refusal("output_dir", "a\nb"), {"control character"}));
}

TEST(Options, a_missing_value_is_refused_for_all_but_flags) {
  for (const std::string name : {"courant", "pipe_cells_per_diameter", "output_dir", "basis",
                                 "contact_friction", "particle_output_times"})
    EXPECT_TRUE(says(refusal(name, ""),
                     {"-" + name + " (input/pipe.opts:12)", "needs a value", "allowed: "}))
        << name;
}

TEST(Options, an_unknown_option_names_the_nearest_known_one) {
  EXPECT_TRUE(says(refusal("corant", "0.5"), {"-corant 0.5 (input/pipe.opts:12)", "unknown option",
                                              "-help", "the nearest is -courant"}));
  EXPECT_TRUE(says(refusal("sand_voidratio", "1"), {"the nearest is -sand_void_ratio"}));
  EXPECT_TRUE(says(refusal("Courant", "1"), {"the nearest is -courant"}));
  EXPECT_TRUE(says(refusal("option_file", "a"), {"the nearest is -options_file"}));
}

TEST(Options, an_unknown_option_without_a_value_is_unknown_first) {
  EXPECT_TRUE(says(refusal("dry_run", ""), {"-dry_run (input/pipe.opts:12) is an unknown"}));
}

TEST(Options, a_missing_required_option_is_refused) {
  Sample sample;
  EXPECT_TRUE(says(refusal_of([&] { sample.options.assign({}); }),
                   {"-scene (not given) is required", "allowed: text", "give it as -scene VALUE"}));
}

TEST(Options, the_first_of_equally_near_words_is_the_nearest) {
  const std::vector<std::string> words{"usl", "usf", "musl"};
  EXPECT_EQ(nearest("usx", words), "usl");
  EXPECT_EQ(nearest("mull", words), "musl");
  EXPECT_EQ(nearest("f", words), "usf");
  EXPECT_EQ(nearest("usl", {}), "");
}

// ---------------------------------------------------------------- declarations

TEST(Options, declaring_a_name_twice_is_a_programming_error) {
  Sample sample;
  double other = 0.3;
  EXPECT_THROW(sample.options.real("courant", other, positive(), {}), std::logic_error);
}

TEST(Options, declaring_a_name_of_petsc_or_of_the_program_is_a_programming_error) {
  OptionSet options;
  double value = 0.3;
  for (const std::string name : {"log_view", "malloc_debug", "help", "options_file"})
    EXPECT_THROW(options.real(name, value, positive(), {}), std::logic_error) << name;
}

TEST(Options, a_default_that_is_not_allowed_is_a_programming_error) {
  OptionSet options;
  double negative = -0.3;
  double undefined = std::nan("");
  EXPECT_THROW(options.real("a", negative, positive(), {}), std::logic_error);
  EXPECT_THROW(options.real("b", undefined, {}, {}), std::logic_error);
}

TEST(Options, asking_for_an_undeclared_option_is_a_programming_error) {
  const Sample sample;
  EXPECT_THROW(sample.options.is_given("corant"), std::logic_error);
  EXPECT_THROW(sample.options.given("corant"), std::logic_error);
}

TEST(Options, ranges_read_like_a_sentence) {
  EXPECT_EQ(describe(positive()), "> 0");
  EXPECT_EQ(describe(not_negative()), ">= 0");
  EXPECT_EQ(describe(between(0.2, 2.0)), "0.2 to 2");
  EXPECT_EQ(describe(at_least(1)), ">= 1");
  EXPECT_EQ(describe(IntegerRange{.minimum = 1, .maximum = 1000000000}), "1 to 1000000000");
  EXPECT_EQ(describe(RealRange{.maximum = -2.5}), "<= -2.5");
  EXPECT_EQ(describe(RealRange{.maximum = 3.0, .open_maximum = true}), "< 3");
  EXPECT_EQ(describe(RealRange{}), "");
}

// ---------------------------------------------------------------- texts

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

TEST(Options, help_shows_everything_declared) {
  const Sample sample;
  const std::string help = sample.options.help();
  EXPECT_TRUE(says(help, {"Run\n  -scene <required>"}));
  EXPECT_TRUE(says(help, {"\n\nPipe\n  -sand_void_ratio <0.55>"}));
  EXPECT_TRUE(says(help, {"-contact_friction <tan(0.6 phi_c)>"}));
  EXPECT_TRUE(says(help, {"-particle_output_times <0.1,0.25>"}));
  EXPECT_TRUE(says(help, {"linear | quadratic | cubic"}));
  EXPECT_TRUE(says(help, {"      Friction of the pipe. [Eq. 12]\n"}));
}

TEST(Options, help_aligns_what_is_allowed) {
  const Sample sample;
  std::size_t column = 0;
  for (const std::string& line : lines_of(sample.options.help())) {
    const std::size_t at = line.find("real, ");
    if (at == std::string::npos) continue;
    if (column == 0) column = at;
    EXPECT_EQ(at, column) << line;
  }
  EXPECT_GT(column, 0U);
}

TEST(Options, help_fits_in_100_columns) {
  Sample sample;
  double value = 0.3;
  std::string sentence = "Long";
  while (sentence.size() < 400) sentence += " sentence about something";
  sample.options.real("a_name_that_is_quite_long_for_an_option", value, positive(),
                      {"N/m", sentence, "chosen: see docs/model.md"});
  Basis other = Basis::cubic;
  sample.options.choice("another_name_that_is_longer_than_its_column", other,
                        {{"linear_functions_with_a_long_name", Basis::linear},
                         {"quadratic_functions_with_a_long_name", Basis::quadratic},
                         {"cubic_functions_with_a_long_name", Basis::cubic}},
                        {"", "Short.", ""});
  for (const std::string& line : lines_of(sample.options.help()))
    EXPECT_LE(line.size(), 100U) << line;
  EXPECT_TRUE(says(without_line_ends(sample.options.help()), {"docs/model.md]"}));
}

TEST(Options, pages_and_help_show_defaults_not_given_values) {
  Sample sample;
  sample.assign("courant", "0.7");
  EXPECT_TRUE(says(sample.options.help(), {"-courant <0.4>"}));
  const std::vector<Row> rows = sample.options.rows();
  EXPECT_EQ(std::ranges::find(rows, "courant", &Row::name)->initial, "0.4");
}

TEST(Options, values_are_the_present_ones_in_declared_order) {
  Sample sample;
  sample.assign("courant", "0.7");
  EXPECT_EQ(sample.options.values(),
            (std::vector<std::pair<std::string, std::string>>{{"scene", "pipe"},
                                                              {"output_dir", "out/pipe"},
                                                              {"basis", "quadratic"},
                                                              {"courant", "0.7"},
                                                              {"particle_output_times", "0.1,0.25"},
                                                              {"sand_void_ratio", "0.55"},
                                                              {"pipe_embedment_ratio", "3"},
                                                              {"sand_c", "0.75"},
                                                              {"confining_pressure", "250000"},
                                                              {"pipe_cells_per_diameter", "8"},
                                                              {"half", "false"},
                                                              {"contact_friction", ""}}));
}

TEST(Options, used_leaves_out_what_is_not_set) {
  Sample sample;
  sample.assign("courant", "0.7");
  const std::string used = sample.options.used();
  EXPECT_TRUE(says(used, {"# Run\n"}));
  EXPECT_TRUE(says(used, {"-courant 0.7  "}));
  EXPECT_TRUE(says(used, {"# -contact_friction: tan(0.6 phi_c)"}));
  EXPECT_TRUE(says(used, {"# Pa; Pressure at the start.\n"}));
  EXPECT_FALSE(says(used, {"\n-contact_friction"}));
}

TEST_F(OptionsFile, used_reproduces_the_run_exactly) {
  Sample first;
  first.assign({{"courant", "0.1234567890123456789", "x"},
                {"confining_pressure", "3.3333333333333333e-7", "x"},
                {"output_dir", "-out/a b #1", "x"},
                {"particle_output_times", "0.3333333333333333,1e300", "x"},
                {"contact_friction", "0.1", "x"},
                {"half", "true", "x"},
                {"basis", "cubic", "x"},
                {"pipe_cells_per_diameter", "9007199254740993", "x"}});
  const std::string file = write("used.opts", first.options.used());
  Sample second;
  second.options.assign(parse({"-options_file", file.c_str()}).own);
  EXPECT_EQ(second.courant, first.courant);
  EXPECT_EQ(second.pressure, first.pressure);
  EXPECT_EQ(second.directory, "-out/a b #1");
  EXPECT_EQ(second.times, first.times);
  EXPECT_EQ(second.friction, 0.1);
  EXPECT_TRUE(second.half);
  EXPECT_EQ(second.basis, Basis::cubic);
  EXPECT_EQ(second.cells, 9007199254740993);
  EXPECT_EQ(second.options.values(), first.options.values());
  EXPECT_EQ(second.options.used(), first.options.used());
}

// ---------------------------------------------------------------- command line

TEST(CommandLine, no_arguments_ask_for_nothing) {
  const CommandLine line = parse({});
  EXPECT_FALSE(line.help || line.version || line.list_scenes);
  EXPECT_TRUE(line.own.empty());
  EXPECT_TRUE(line.petsc.empty());
}

TEST(CommandLine, the_arguments_of_main_are_taken_as_they_are) {
  std::string program = "mpmsolve", name = "-scene", value = "pipe";
  char* argv[] = {program.data(), name.data(), value.data(), nullptr};
  const int argc = 3;
  EXPECT_EQ(read_command_line({argv + 1, argv + argc}).value_of("scene"), "pipe");
}

TEST(CommandLine, options_have_values_and_the_command_line_as_origin) {
  const CommandLine line = parse({"-scene", "pipe", "-courant", "0.3"});
  ASSERT_EQ(line.own.size(), 2U);
  EXPECT_EQ(line.own[1].name, "courant");
  EXPECT_EQ(line.own[1].value, "0.3");
  EXPECT_EQ(line.own[1].origin, "command line");
  EXPECT_EQ(line.value_of("scene"), "pipe");
  EXPECT_EQ(line.value_of("output_dir"), std::nullopt);
}

TEST(CommandLine, negative_numbers_are_values) {
  for (const char* value : {"-0.5", "-1e3", "-.5", "-7", "-inf", "-nan", "-1,-2"})
    EXPECT_EQ(parse({"-gravity", value}).value_of("gravity"), value);
}

TEST(CommandLine, help_and_version_have_several_spellings) {
  for (const char* word : {"-help", "--help", "-h"}) EXPECT_TRUE(parse({word}).help) << word;
  for (const char* word : {"-version", "--version"}) EXPECT_TRUE(parse({word}).version) << word;
  EXPECT_TRUE(parse({"-scene", "pipe", "-help"}).help);
  EXPECT_TRUE(parse({"-help", "-version"}).own.empty());
}

TEST(CommandLine, scene_list_asks_for_the_list) {
  EXPECT_TRUE(parse({"-scene", "list"}).list_scenes);
  EXPECT_FALSE(parse({"-scene", "pipe"}).list_scenes);
}

TEST(CommandLine, dry_run_is_an_option_like_any_other) {
  EXPECT_NE(find(parse({"-scene", "pipe", "-dry_run"}).own, "dry_run"), nullptr);
}

TEST(CommandLine, petsc_options_pass_with_and_without_values) {
  const CommandLine line = parse({"-log_view", "-malloc_debug", "true", "-scene", "pipe",
                                  "-options_left", "no", "-log_trace", "steps.txt", "-info"});
  ASSERT_EQ(line.petsc.size(), 5U);
  EXPECT_EQ(find(line.petsc, "log_view")->value, "");
  EXPECT_EQ(find(line.petsc, "malloc_debug")->value, "true");
  EXPECT_EQ(find(line.petsc, "log_trace")->value, "steps.txt");
  EXPECT_EQ(line.own.size(), 1U);
}

TEST(CommandLine, petsc_options_that_bypass_the_checks_do_not_pass) {
  for (const char* name : {"-da_grid_x", "-dm_refine", "-options_file_yaml", "-prefix_push",
                           "-options_string_yaml", "-history", "-logview"})
    EXPECT_TRUE(parse({name, "3"}).petsc.empty()) << name;
}

TEST(CommandLine, stray_words_are_refused) {
  EXPECT_TRUE(
      says(parse_refusal({"pipe"}), {"'pipe' (command line) is a stray word", "-name value"}));
  EXPECT_TRUE(says(parse_refusal({"-scene", "pipe", "0.5"}), {"'0.5'", "stray word after -scene"}));
  EXPECT_TRUE(says(parse_refusal({"-help", "intro"}), {"'intro'"}));
  EXPECT_TRUE(says(parse_refusal({"-scene", "pipe", ""}), {"''"}));
}

TEST(CommandLine, an_equals_sign_is_refused_with_the_right_spelling) {
  EXPECT_TRUE(
      says(parse_refusal({"-courant=0.3"}), {"-courant=0.3 (command line)", "write -courant 0.3"}));
}

TEST(CommandLine, an_option_twice_with_different_values_is_refused_with_both) {
  EXPECT_TRUE(says(parse_refusal({"-courant", "0.3", "-scene", "pipe", "-courant", "0.4"}),
                   {"-courant 0.4 (command line)", "contradicts the earlier '0.3' (command line)",
                    "one value"}));
  EXPECT_TRUE(says(parse_refusal({"-courant", "0.3", "-courant"}), {"contradicts"}));
}

TEST(CommandLine, an_option_twice_with_the_same_value_is_one_option) {
  EXPECT_EQ(parse({"-courant", "0.3", "-courant", "0.3"}).own.size(), 1U);
}

TEST(CommandLine, an_option_before_another_has_no_value) {
  const CommandLine line = parse({"-courant", "-scene", "pipe"});
  Sample sample;
  EXPECT_TRUE(says(refusal_of([&] { sample.options.assign(line.own); }),
                   {"-courant (command line) needs a value", "> 0 and <= 2"}));
  EXPECT_TRUE(says(refusal_of([] { parse({"-scene"}).value_of("scene"); }),
                   {"-scene (command line) needs a value", "-scene VALUE"}));
}

// ---------------------------------------------------------------- options files

TEST_F(OptionsFile, lines_are_read_with_comments_blanks_and_quotes) {
  const std::string file = write("pipe.opts",
                                 "# A pipe, 0.55 \xCF\x86\n"
                                 "\n"
                                 "   -courant   0.3 # stable\n"
                                 "\t-output_dir \"out/a b # c\"\t#comment\r\n"
                                 "-tag a#b\n"
                                 "-literal \"-name\"\n"
                                 "-gravity -9.81\n"
                                 "-log_view\n"
                                 "-half");
  const CommandLine line = parse({"-options_file", file.c_str()});
  EXPECT_EQ(line.value_of("courant"), "0.3");
  EXPECT_EQ(line.value_of("output_dir"), "out/a b # c");
  EXPECT_EQ(line.value_of("tag"), "a#b");
  EXPECT_EQ(line.value_of("literal"), "-name");
  EXPECT_EQ(line.value_of("gravity"), "-9.81");
  EXPECT_EQ(line.petsc.size(), 1U);
  EXPECT_EQ(find(line.own, "courant")->origin, file + ":3");
  EXPECT_EQ(find(line.own, "half")->origin, file + ":9");
}

TEST_F(OptionsFile, a_byte_order_mark_is_skipped) {
  const std::string file = write("a.opts", "\xEF\xBB\xBF-courant 0.3\n");
  EXPECT_EQ(parse({"-options_file", file.c_str()}).value_of("courant"), "0.3");
}

TEST_F(OptionsFile, an_empty_file_gives_nothing) {
  const std::string file = write("empty.opts", "");
  EXPECT_TRUE(parse({"-options_file", file.c_str()}).own.empty());
}

TEST_F(OptionsFile, later_files_override_earlier_and_the_command_line_overrides_files) {
  const std::string first = write("1.opts", "-a 1\n-b 1\n-c 1\n");
  const std::string second = write("2.opts", "-b 2\n-c 2\n");
  const CommandLine line =
      parse({"-c", "3", "-options_file", first.c_str(), "-options_file", second.c_str()});
  EXPECT_EQ(line.value_of("a"), "1");
  EXPECT_EQ(line.value_of("b"), "2");
  EXPECT_EQ(line.value_of("c"), "3");
  EXPECT_EQ(find(line.own, "a")->origin, first + ":1");
  EXPECT_EQ(find(line.own, "b")->origin, second + ":1");
  EXPECT_EQ(find(line.own, "c")->origin, "command line");
  EXPECT_EQ(line.own.size(), 3U);
}

TEST_F(OptionsFile, a_contradiction_within_a_file_names_both_lines) {
  EXPECT_TRUE(says(refusal_of_text("-courant 0.3\n\n-courant 0.4\n"),
                   {"-courant 0.4 (" + path("bad.opts") + ":3)",
                    "contradicts the earlier '0.3' (" + path("bad.opts") + ":1)"}));
}

TEST_F(OptionsFile, the_same_value_twice_in_a_file_is_fine) {
  const std::string file = write("a.opts", "-courant 0.3\n-courant 0.3\n");
  EXPECT_EQ(parse({"-options_file", file.c_str()}).own.size(), 1U);
}

TEST_F(OptionsFile, stray_words_are_refused_with_their_line) {
  const std::string place = "(" + path("bad.opts") + ":2)";
  EXPECT_TRUE(
      says(refusal_of_text("-a 1\ncourant 0.3\n"), {"'courant' " + place, "one -name value"}));
  EXPECT_TRUE(
      says(refusal_of_text("-a 1\n! comment\n"), {"'!' " + place, "comments that start with #"}));
  EXPECT_TRUE(says(refusal_of_text("-a 1\n-courant 0.3 0.4\n"),
                   {"'0.4' " + place, "stray word after -courant"}));
}

TEST_F(OptionsFile, two_options_on_a_line_are_refused) {
  EXPECT_TRUE(says(refusal_of_text("-courant 0.3 -gravity 9\n"),
                   {"-gravity 9", "-courant", "one option a line"}));
}

TEST_F(OptionsFile, an_open_quote_is_refused) {
  EXPECT_TRUE(
      says(refusal_of_text("-output_dir \"out\n"), {"-output_dir \"out", ":1)", "closing"}));
}

TEST_F(OptionsFile, an_options_file_inside_an_options_file_is_refused) {
  EXPECT_TRUE(
      says(refusal_of_text("-options_file other.opts\n"),
           {"-options_file other.opts", ":1)", "allowed: -options_file on the command line"}));
}

TEST_F(OptionsFile, files_that_cannot_be_read_are_refused) {
  const std::string missing = path("missing.opts");
  EXPECT_TRUE(says(parse_refusal({"-options_file", missing.c_str()}),
                   {"-options_file " + missing + " (command line) does not exist",
                    "allowed: a readable text file"}));
  const std::string directory = std::filesystem::path(missing).parent_path().string();
  EXPECT_TRUE(says(parse_refusal({"-options_file", directory.c_str()}), {"is a directory"}));
  EXPECT_TRUE(says(parse_refusal({"-options_file"}), {"-options_file (command line) needs a"}));
  EXPECT_TRUE(says(parse_refusal({"-options_file", "-courant", "0.3"}), {"needs a value"}));
}

TEST(CommandLine, a_file_that_opens_but_cannot_be_read_is_refused) {
  EXPECT_TRUE(says(parse_refusal({"-options_file", "/proc/self/mem"}),
                   {"-options_file /proc/self/mem (command line) cannot be read"}));
}

TEST_F(OptionsFile, foreign_files_are_refused_in_one_line) {
  using namespace std::string_literals;
  for (const std::string& bytes : {"\x89HDF\r\n\x1a\n\0\0"s, "\x89PNG\r\n\x1a\n"s,
                                   "\x7f"
                                   "ELF\2"s,
                                   "-courant 0.3\0"s}) {
    const std::string message = refusal_of_text(bytes);
    EXPECT_TRUE(says(message, {"-options_file " + path("bad.opts"), "is not a text file"}));
    EXPECT_EQ(message.find('\n'), std::string::npos);
  }
  EXPECT_TRUE(says(refusal_of_text("{\"scene\": \"pipe\"}\n"), {"does not start an option"}));
  EXPECT_TRUE(says(refusal_of_text(std::string(2 << 20, '#')), {"larger than 1 MiB"}));
}

/// Pumps named in a list, each with a power and a drive that has options of its own.
struct Pumps {
  struct Pump {
    double power = 1.5;
    bool is_electric = false;
    double voltage = 230.0;
  };
  std::vector<std::string> names;
  std::map<std::string, Pump> pumps;
  OptionSet options;

  Pumps() {
    options.names("pumps", names, {"", "What pumps there are.", "chosen"});
    options.opens(
        [this] {
          for (const auto& name : names) declare(name);
        },
        [this] { declare("NAME"); });
  }
  void declare(const std::string& name) {
    options.prefixed("pump_" + name + "_", [&] {
      Pump& pump = pumps[name];
      options.real("power", pump.power, positive(), {"W", "Power.", "chosen"});
      options.choice("drive", pump.is_electric, {{"diesel", false}, {"electric", true}},
                     {"", "Drive.", "chosen"});
      const auto declare_voltage = [this, &pump] {
        options.real("voltage", pump.voltage, positive(), {"V", "Voltage.", "chosen"});
      };
      options.opens(
          [&pump, declare_voltage] {
            if (pump.is_electric) declare_voltage();
          },
          declare_voltage);
    });
  }
};

TEST(OptionSet, what_a_list_names_has_options_of_its_own) {
  Pumps set;
  const std::vector<Given> given{{"pump_b_power", "7.5", "here"},
                                 {"pump_b_voltage", "400", "here"},
                                 {"pump_b_drive", "electric", "here"},
                                 {"pumps", "a,b", "here"}};
  set.options.assign(given);
  EXPECT_EQ(set.names, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(set.pumps["a"].power, 1.5);
  EXPECT_EQ(set.pumps["b"].power, 7.5);
  EXPECT_EQ(set.pumps["b"].voltage, 400.0);
}

TEST(OptionSet, options_that_nothing_opened_are_unknown) {
  for (const Given& wrong :
       {Given{"pump_c_power", "7.5", "here"}, Given{"pump_a_voltage", "400", "here"}}) {
    Pumps set;
    const std::vector<Given> given{{"pumps", "a", "here"}, wrong};
    EXPECT_THROW(set.options.assign(given), BadInput);
  }
}

TEST(OptionSet, a_list_of_names_takes_names_only_and_each_once) {
  for (const char* wrong : {"a,a", "a,", ",a", "a b", "2a", "a_b", "a-b"}) {
    Pumps set;
    const std::vector<Given> given{{"pumps", wrong, "here"}};
    EXPECT_THROW(set.options.assign(given), BadInput) << wrong;
  }
}

TEST(OptionSet, pages_show_an_example_of_what_a_list_names) {
  Pumps set;
  set.options.open_examples();
  std::vector<std::string> names;
  for (const Row& row : set.options.rows()) names.push_back(row.name);
  EXPECT_EQ(names, (std::vector<std::string>{"pumps", "pump_NAME_power", "pump_NAME_drive",
                                             "pump_NAME_voltage"}));
}

/// A valve that has a spring in one kind only.
struct Valve {
  double stiffness = 40.0, pressure = 3.0;
  bool has_spring = false;
  OptionSet options{"valve"};

  Valve() {
    options.flag("has_spring", has_spring, {"", "sentence", ""});
    options.real("stiffness", stiffness, positive(), {"N/m", "sentence", ""});
    options.effective([this] { return has_spring; }, "only with -has_spring");
    options.caution(
        [this] { return pressure > 5.0 ? std::string("the pressure is high") : std::string(); });
    options.real("pressure", pressure, positive(), {"Pa", "sentence", ""});
  }
  std::vector<std::string> cautions(std::vector<Given> given) {
    options.assign(given);
    return options.cautions();
  }
};

TEST(OptionSet, an_option_without_effect_is_a_caution) {
  EXPECT_EQ(Valve().cautions({{"stiffness", "70", "here"}}),
            std::vector<std::string>{"-stiffness 70 has no effect: only with -has_spring"});
  EXPECT_TRUE(
      Valve().cautions({{"stiffness", "70", "here"}, {"has_spring", "true", "here"}}).empty());
  EXPECT_TRUE(Valve().cautions({{"stiffness", "40", "here"}}).empty());
}

TEST(OptionSet, cautions_come_from_the_values_as_they_were_set) {
  Valve valve;
  EXPECT_TRUE(valve.cautions({{"pressure", "4.5", "here"}}).empty());
  EXPECT_EQ(Valve().cautions({{"pressure", "5.5", "here"}}),
            std::vector<std::string>{"the pressure is high"});
}

TEST(OptionSet, rows_say_what_the_pages_print) {
  Sample sample;
  const std::vector<Row> rows = sample.options.rows();
  const auto courant = std::ranges::find(rows, "courant", &Row::name);
  ASSERT_NE(courant, rows.end());
  EXPECT_EQ(courant->section, "Run");
  EXPECT_EQ(courant->initial, "0.4");
  EXPECT_EQ(courant->unit, "-");
  EXPECT_EQ(courant->allowed, "real, > 0 and <= 2");
  EXPECT_EQ(rows.front().initial, "required");
}

}  // namespace
}  // namespace mpm::options
