#pragma once

#include <span>
#include <string_view>

namespace mpm::io {

/// What an answer of summary.json is.
struct Answer {
  std::string_view key;  ///< `*` stands for any text
  std::string_view unit;
  std::string_view sentence;
};

/// Answers of one kind, a section of docs/results.md.
struct AnswerGroup {
  std::string_view title;
  std::span<const Answer> answers;
};

/// All answers, each declared once: a key means one thing, whatever the case.
std::span<const AnswerGroup> vocabulary();

/// The declaration of a key, null where there is none.
const Answer* find_answer(std::string_view key);

}  // namespace mpm::io
