// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/page_template.h"

#include <stdexcept>

namespace limber::program {

std::string filled_page(Json data, const std::string& command_line) {
  constexpr std::string_view placeholder = "\"data of the page\"";
  const std::size_t at = viewer_template.find(placeholder);
  if (at == std::string_view::npos) throw std::logic_error("the viewer has no place for its data");
  data["version"] = LIMBER_VERSION;
  data["command"] = command_line;
  std::string filled(viewer_template.substr(0, at));
  for (const char c : to_line(data)) {
    if (c == '<') {
      filled += "\\u003c";  // no name of a file ends the script that the data stands in
    } else {
      filled += c;
    }
  }
  return filled.append(viewer_template.substr(at + placeholder.size()));
}

}  // namespace limber::program
