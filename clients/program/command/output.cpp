// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/output.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "command/terminal.h"
#include "command/text.h"

namespace limber::program {
namespace {

std::string quoted(const std::string& text) {
  return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);  // file names need not be UTF-8
}

void append(std::string& line, const Json& json) {
  if (json.is_structured()) {
    line += json.is_object() ? '{' : '[';
    const char* separator = "";
    for (const auto& [key, value] : json.items()) {
      line += separator;
      if (json.is_object()) line += quoted(key) + ": ";
      append(line, value);
      separator = ", ";
    }
    line += json.is_object() ? '}' : ']';
  } else if (json.is_string()) {
    line += quoted(json.get<std::string>());
  } else if (json.is_number_float()) {
    const double number = json.get<double>();
    if (!std::isfinite(number)) throw std::logic_error("an answer is not finite");
    line += to_text(number);
  } else {
    line += json.dump();
  }
}

/// A text as one field of CSV: in quotes where it must be.
std::string csv_field(std::string_view text) {
  const bool is_plain = text.find_first_of(",;\"\r\n#") == std::string_view::npos && trimmed(text) == text;
  if (is_plain) return std::string(text);
  std::string field = "\"";
  for (const char c : text) {
    if (c == '"') field += '"';
    field += c;
  }
  return field + '"';
}

std::size_t cell_count(std::string_view key) {
  return key == "witness" ? 10 : key == "pair" ? 18 : key == "touch" ? 15 : key == "closest" ? 9 : 1;
}

/// Appends cells, each with a comma after it.
void append_cells(std::string& line, const std::string& key, const Json& json) {
  if (json.is_structured()) {
    for (const auto& [inner_key, value] : json.items()) append_cells(line, inner_key, value);
  } else if (json.is_null()) {
    line.append(cell_count(key), ',');
  } else {
    if (json.is_string()) {
      line += csv_field(json.get_ref<const std::string&>());
    } else {
      append(line, json);
    }
    line += ',';
  }
}

constexpr double bar_redraw_s = 0.1;

}  // namespace

void fail_to_write(const std::string& name, int reason) {
  throw OutputFailed(reason == EPIPE ? "" : fmt::format("cannot write {}: {}", name, std::strerror(reason)));
}

void write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail_to_write("to standard output", errno);
}

void flush() {
  if (std::fflush(stdout) != 0) fail_to_write("to standard output", errno);
}

void show(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

ProgressBar::ProgressBar(std::size_t count, const char* unit)
    : count_(count), unit_(unit), is_shown_(is_terminal(stderr)) {}

void ProgressBar::clear() {
  if (stands_) show("\r\033[K");
  stands_ = false;
}

void ProgressBar::draw(std::size_t done) {
  if (!is_shown_ || (stands_ && done < count_ && since_drawn_.seconds() < bar_redraw_s)) return;
  constexpr std::size_t width = 40;
  const std::size_t filled = width * done / count_;
  show(fmt::format("\r[{:#<{}}{:.<{}}] {}/{} {}", "", filled, "", width - filled, done, count_, unit_));
  stands_ = true;
  since_drawn_ = Stopwatch();
}

void warn(const std::string& verb, const std::string& text) {
  show(on_one_line("limber: " + verb + ": warning: " + text) + '\n');
}

std::string to_line(const Json& json) {
  std::string line;
  append(line, json);
  return line + '\n';
}

std::string csv_line(const Json& json) {
  std::string line;
  append_cells(line, {}, json);
  line.back() = '\n';
  return line;
}

std::string spaced(const std::string& columns) { return fmt::format("{}", fmt::join(fields_of(columns, ','), ", ")); }

Json to_json(const Vec3& point) { return Json::array({point.x, point.y, point.z}); }

const char* to_text(DistanceStatus status) {
  const auto* const found = std::find_if(status_words.begin(), status_words.end(),
                                         [status](const auto& entry) { return entry.first == status; });
  if (found == status_words.end()) throw std::logic_error("an answer has no known status");
  return found->second;
}

std::string on_one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  }
  return line;
}

}  // namespace limber::program
