#include "data/verify/findings.hpp"

#include <fmt/format.h>

namespace palpate::data {

std::size_t Verification::count(FindingKind kind) const noexcept {
    std::size_t found = 0;
    const auto add = [&](const std::vector<Finding>& findings) {
        for (const Finding& finding : findings) {
            found += finding.kind == kind ? 1 : 0;
        }
    };
    add(file);
    for (const SessionReport& session : sessions) {
        add(session.findings);
    }
    return found;
}

void Findings::differs(std::string_view what, std::string stored, std::string recomputed) {
    add({.kind = FindingKind::differs,
         .trial = {},
         .tick = {},
         .what = std::string(what),
         .stored = std::move(stored),
         .recomputed = std::move(recomputed)});
}

void Findings::missing(std::string_view what, std::string why) {
    add({.kind = FindingKind::missing,
         .trial = {},
         .tick = {},
         .what = std::string(what),
         .stored = {},
         .recomputed = std::move(why)});
}

void Findings::expect(std::string_view table,
                      std::string_view column,
                      const StoredRow& row,
                      const Value& recomputed) {
    if (!same(row.at(column), recomputed)) {
        differs(fmt::format("{}.{}", table, column), to_text(row.at(column)), to_text(recomputed));
    }
}

void Findings::add(Finding finding) {
    if (!finding.trial) {
        finding.trial = trial_;
    }
    all_.push_back(std::move(finding));
}

}  // namespace palpate::data
