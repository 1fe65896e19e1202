// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/text.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

namespace limber::program {
namespace {

/// The fewest insertions, deletions, replacements and swaps of neighbours that lead from one word to the other.
std::size_t edit_distance(std::string_view from, std::string_view to) {
  // Between the first i characters of one word and the first j of the other.
  std::vector<std::vector<std::size_t>> distance(from.size() + 1, std::vector<std::size_t>(to.size() + 1));
  for (std::size_t i = 0; i <= from.size(); ++i) {
    for (std::size_t j = 0; j <= to.size(); ++j) {
      std::size_t& fewest = distance[i][j] = i + j;
      if (i == 0 || j == 0) continue;
      const std::size_t replaced = distance[i - 1][j - 1] + (from[i - 1] == to[j - 1] ? 0 : 1);
      fewest = std::min({replaced, distance[i - 1][j] + 1, distance[i][j - 1] + 1});
      const bool is_swapped = i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1];
      if (is_swapped) fewest = std::min(fewest, distance[i - 2][j - 2] + 1);
    }
  }
  return distance.back().back();
}

std::string_view without_dashes(std::string_view word) {
  return word.substr(std::min(word.find_first_not_of('-'), word.size()));
}

}  // namespace

std::optional<double> parsed_number(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
#if defined(_LIBCPP_VERSION) && (_LIBCPP_VERSION < 200000 || defined(__APPLE__))
  // Its std::from_chars reads no doubles. The program sets no locale, so the point is a point to strtod.
  if (text.empty() || text.front() == '+' || text.find_first_of("xX( \t\n\v\f\r") != text.npos) return std::nullopt;
  const std::string word(text);
  char* stop = nullptr;
  const double number = std::strtod(word.c_str(), &stop);
  return stop == word.c_str() + word.size() ? std::optional(number) : std::nullopt;
#else
  double number = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (text.empty() || stop != text.data() + text.size()) return std::nullopt;
  if (error == std::errc::result_out_of_range) return std::strtod(std::string(text).c_str(), nullptr);  // 0 or infinity
  if (error != std::errc{}) return std::nullopt;
  return number;
#endif
}

std::string to_text(double number) { return fmt::format("{}", number); }

std::string to_text(const Vec3& point) { return fmt::format("{} {} {}", point.x, point.y, point.z); }

std::string grouped(std::uint64_t count) {
  std::string text = fmt::format("{}", count);
  for (std::size_t end = text.size(); end > 3; end -= 3) text.insert(end - 3, 1, ' ');
  return text;
}

std::string duration_text(double microseconds) {
  if (microseconds < 10) return fmt::format("{:.2f} us", microseconds);
  return grouped(static_cast<std::uint64_t>(std::llround(microseconds))) + " us";
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view blanks = " \t\r\n";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::vector<std::string_view> fields_of(std::string_view text, char separator) {
  std::vector<std::string_view> fields;
  while (true) {
    const std::size_t end = text.find(separator);
    fields.push_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) return fields;
    text.remove_prefix(end + 1);
  }
}

std::string shown(std::string_view text) {
  constexpr std::size_t longest = 30;
  std::string part(text.substr(0, longest));
  std::replace_if(
      part.begin(), part.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return part + (text.size() > longest ? "..." : "");
}

std::optional<std::string> nearest(std::string_view word, const std::vector<std::string>& candidates) {
  constexpr std::size_t shortest_start = 3;
  const std::string_view typed = without_dashes(word);
  std::size_t best = 2 + typed.size() / 5;  // one slip in a short word, more in a long one
  std::optional<std::string> found;
  for (const std::string& candidate : candidates) {
    const std::string_view name = without_dashes(candidate);
    const bool is_start =
        std::min(typed.size(), name.size()) >= shortest_start && (name.starts_with(typed) || typed.starts_with(name));
    const std::size_t distance = is_start ? 1 : edit_distance(typed, name);
    if (distance >= best || distance >= name.size()) continue;
    best = distance;
    found = candidate;
  }
  return found;
}

std::string wrapped(std::string_view text, std::size_t width) {
  std::string lines;
  std::size_t column = 0;
  const auto end_line = [&] {
    if (column > 0) lines += '\n';
    column = 0;
  };
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (line.empty() || line.front() == ' ') {
      end_line();
      lines.append(line).append("\n");
      continue;
    }
    for (const std::string_view word : fields_of(line, ' ')) {
      if (word.empty()) continue;
      if (column > 0 && column + 1 + word.size() > width) end_line();
      if (column > 0) lines += ' ';
      lines += word;
      column += word.size() + (column > 0 ? 1 : 0);
    }
  }
  if (column == 0 && !lines.empty()) lines.pop_back();
  return lines;
}

}  // namespace limber::program
