#include "data/sync/last_version.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace palpate::data {
namespace {

/// Of one a score was destroyed, and the other went on without that.
MergeConflict half_destroyed(const SessionVersion& one, const SessionVersion& other) {
    const bool first = one.destructions < other.destructions;
    return {.what = called(one) + ": details were destroyed in one file, and it went on in another",
            .first = one.file,
            .second = other.file,
            .remedy = fmt::format("palpate participant {} {} --destroy details does it there, too",
                                  (first ? one : other).file, one.participant)};
}

/// One of them was destroyed, for somebody whose it is not in the other file.
MergeConflict destroyed_as_anothers(const SessionVersion& one, const SessionVersion& other) {
    const SessionVersion& gone = one.destroyed ? one : other;
    const SessionVersion& there = one.destroyed ? other : one;
    return {.what = fmt::format("{}: {} has it as {}'s, of whom everything was destroyed there",
                                called(there), gone.file, gone.participant),
            .first = there.file,
            .second = gone.file,
            .remedy = fmt::format("--prefer {} if it is {}'s; else palpate participant {} {} "
                                  "--is-really {} and --destroy everything",
                                  there.file, there.participant, there.file, there.participant,
                                  gone.participant)};
}

}  // namespace

std::string called(const SessionVersion& session) {
    return fmt::format("{}, participant {}, session {} ({})", session.study_name,
                       session.participant, session.number, session.uuid);
}

std::vector<const SessionVersion*> latest_of(const Versions& versions) {
    std::vector<const SessionVersion*> latest;
    for (const SessionVersion& version : versions) {
        const auto before = [&](const SessionVersion* one) {
            return became(version, *one);
        };
        if (std::ranges::none_of(latest, before)) {
            std::erase_if(latest, [&](const auto* one) { return became(*one, version); });
            latest.push_back(&version);
        }
    }
    return latest;
}

const SessionVersion* last_of(const Versions& versions,
                              const std::string& prefer,
                              PeopleMerge& people,
                              std::vector<MergeConflict>& conflicts) {
    std::vector<const SessionVersion*> latest = latest_of(versions);
    const SessionVersion* last = latest.front();
    if (latest.size() == 1) {
        return last;
    }
    const auto preferred = std::ranges::find(versions, prefer, &SessionVersion::file);
    const auto others = std::ranges::find_if(latest, [&](const SessionVersion* one) {
        return one->participant != last->participant && (one->destroyed || last->destroyed);
    });
    const auto other = std::ranges::find_if(
        latest, [&](const SessionVersion* one) { return one->destructions != last->destructions; });
    if (others != latest.end() && preferred == versions.end()) {
        conflicts.push_back(destroyed_as_anothers(*last, **others));
        return nullptr;
    }
    if (others == latest.end() && other != latest.end()) {
        people.leave_out(last->participant);
        conflicts.push_back(half_destroyed(*last, **other));
        return nullptr;
    }
    if (preferred != versions.end()) {
        const auto kept = std::ranges::stable_partition(
            latest, [&](const SessionVersion* one) { return became(*preferred, *one); });
        if (kept.begin() - latest.begin() == 1) {
            return latest.front();
        }
    }
    conflicts.push_back({.what = called(*latest[0]) + ": what was recorded differs",
                         .first = latest[0]->file,
                         .second = latest[1]->file,
                         .remedy = kPreferRemedy});
    return nullptr;
}

}  // namespace palpate::data
