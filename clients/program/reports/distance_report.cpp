// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/distance_report.h"

#include <optional>

#include "limber/contacts.h"
#include "reports/page_template.h"
#include "reports/study.h"

namespace limber::program {

Json distance_report(const PlacedArguments& arguments, const Pair& pair, const DistanceQuestion& question,
                     const DistanceAnswer& answer) {
  const PlacedModel a = pair.a(), b = pair.b();
  Study study(StudyKind::pair, question,
              {{shown_name(arguments.a), arguments.a, &a.model, a.pose},
               {shown_name(arguments.b), arguments.b, &b.model, b.pose}});
  study.add(0, {0, 1}, answer, std::nullopt);
  Json json = study.to_json(), &extra = json["pair"];
  append_work(extra, answer.result.stats, pair.build_us(), answer.elapsed_us);
  const bool meet = answer.result.status == DistanceStatus::collision;
  extra["intersections"] = meet ? visit_intersections(a, b, [](const TrianglePair&) { return true; }).count : 0;
  return json;
}

}  // namespace limber::program
