// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "page_decoding.h"

#include <gtest/gtest.h>

namespace limber::program_tests {

Report::Report(const std::string& line) {
  const std::string path = folder.path("page.html");
  outcome = run(line + " --report " + path);
  EXPECT_TRUE(outcome.exit_code == 0 || outcome.exit_code == 3) << line << '\n' << outcome.err;
  page = text_of(path);
  const std::string start = "<script type=\"application/json\" id=\"data\">";
  const std::size_t begin = page.find(start) + start.size();
  data = nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin), nullptr, false);
  EXPECT_TRUE(data.is_object()) << page.substr(begin, 100);
}

}  // namespace limber::program_tests
