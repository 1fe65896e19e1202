// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/output.h"

#include <fmt/ranges.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <initializer_list>

#include "command/text.h"

#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#else
#include <csignal>
#endif

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

/// The names of the columns of an array of three numbers.
std::array<std::string, 3> names_of_three(const std::string& name) {
  if (name == "point") return {"x", "y", "z"};
  if (name == "weights") return {"weight_0", "weight_1", "weight_2"};
  const std::string start = name == "position" ? "closest" : name;
  return {start + "_x", start + "_y", start + "_z"};
}

void append_names(Names& names, const std::string& prefix, const Json& sample) {
  for (const auto& [key, value] : sample.items()) {
    const bool has_no_name = key == "witness" || key == "pair" || key == "closest";
    if (value.is_object()) {
      append_names(names, has_no_name ? prefix : prefix + key + '_', value);
    } else if (value.is_array()) {
      for (const std::string& name : names_of_three(key)) names.push_back(prefix + name);
    } else {
      names.push_back(prefix + key);
    }
  }
}

/// Appends the cells of `json`, or empty ones where it is null, as many as the sample has; each with a comma after it.
void append_cells(std::string& line, const Json& sample, const Json& json) {
  if (sample.is_object()) {
    for (const auto& [key, value] : sample.items()) {
      append_cells(line, value, json.is_object() && json.contains(key) ? json[key] : Json());
    }
  } else if (sample.is_array()) {
    for (std::size_t i = 0; i < sample.size(); ++i) append_cells(line, sample[i], json.is_array() ? json[i] : Json());
  } else {
    if (json.is_string()) {
      line += csv_field(json.get_ref<const std::string&>());
    } else if (!json.is_null()) {
      append(line, json);
    }
    line += ',';
  }
}

}  // namespace

void prepare_streams() {
#if defined(_WIN32)
  for (std::FILE* const stream : {stdout, stderr}) _setmode(_fileno(stream), _O_BINARY);  // line ends stay as they are
#else
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
#endif
}

void fail_to_write(const std::string& name, int reason) {
  throw OutputFailed(reason == EPIPE ? "" : fmt::format("cannot write {}: {}", name, std::strerror(reason)));
}

void write(std::string_view text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) fail_to_write("to standard output", errno);
}

void flush() {
  if (std::fflush(stdout) != 0) fail_to_write("to standard output", errno);
}

void warn(const std::string& verb, const std::string& text) {
  const std::string line = on_one_line("limber: " + verb + ": warning: " + text) + '\n';
  std::fwrite(line.data(), 1, line.size(), stderr);
}

std::string to_line(const Json& json) {
  std::string line;
  append(line, json);
  return line + '\n';
}

AnswerColumns::AnswerColumns(Json sample) : sample_(std::move(sample)) { append_names(names_, {}, sample_); }

std::string AnswerColumns::header() const { return fmt::format("{}\n", fmt::join(names_, ",")); }
std::string AnswerColumns::help() const { return fmt::format("{}", fmt::join(names_, ", ")); }

std::string AnswerColumns::line(const Json& object) const {
  std::string line;
  append_cells(line, sample_, object);
  line.back() = '\n';
  return line;
}

Json to_json(const Vec3& point) { return Json::array({point.x, point.y, point.z}); }

const char* to_text(DistanceStatus status) {
  static constexpr std::array words = {"exact", "within_error", "collision", "beyond_limit", "interrupted"};
  return words.at(static_cast<std::size_t>(status));
}

std::string on_one_line(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') c = ' ';
  }
  return line;
}

}  // namespace limber::program
