#include "data/sync/merge.hpp"

#include <algorithm>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "data/store/chain.hpp"
#include "data/store/people.hpp"
#include "data/store/secret.hpp"
#include "data/store/session_lock.hpp"
#include "data/store/written_rows.hpp"
#include "data/sync/session_version.hpp"

namespace palpate::data {
namespace {

/// An input, and one moment of it.
struct Input {
    explicit Input(const std::string& file)
        : name(file), database(file, Access::read), now(database) {}
    std::string name;
    Database database;
    Snapshot now;
};

/// A session, as it is to be in the file.
struct SessionMerge {
    const SessionVersion* last = nullptr;
    const SessionVersion* own = nullptr;  ///< as the file has it; none: it does not
};

/// Of one session, as the files have it.
using Versions = std::vector<SessionVersion>;

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

/// Those that no other version went on from; of equal ones the first.
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

/// The version that all others became. Where several went on by themselves, that is a conflict, but
/// for the only one that the preferred version became or is. What was destroyed no preference brings
/// back.
/// @return null: a conflict, which is reported
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

/// One study, participant and number can only be one session.
std::set<std::string> doubled(const std::vector<SessionMerge>& all,
                              std::vector<MergeConflict>& conflicts) {
    std::map<std::string, const SessionVersion*> first;
    std::set<std::string> found;
    for (const SessionMerge& each : all) {
        const SessionVersion& one = *each.last;
        const auto [there, is_new] =
            first.emplace(fmt::format("{} {} {}", one.study, one.participant, one.number), &one);
        if (!is_new) {
            found.insert(one.uuid);
            found.insert(there->second->uuid);
            conflicts.push_back(
                {.what = fmt::format("{}: another session of the same number is {}", called(one),
                                     there->second->uuid),
                 .first = there->second->file,
                 .second = one.file,
                 .remedy = fmt::format("where one was run under a wrong code: palpate participant "
                                       "FILE {} --is-really CODE",
                                       one.participant)});
        }
    }
    return found;
}

/// Whom palpate simulate makes, from midnight of 1 January 2000 on, follows from a secret, too: of
/// two secrets and one code there are two people.
void part_simulated(const std::vector<SessionMerge>& all,
                    PeopleMerge& people,
                    std::vector<MergeConflict>& conflicts) {
    std::map<std::string, std::pair<std::string, const SessionVersion*>> first;
    for (const SessionMerge& each : all) {
        const SessionVersion& one = *each.last;
        Statement row = one.database->prepare(
            "SELECT secret FROM session WHERE session_id = ?1 AND session_kind = 'simulated' AND "
            "started_utc LIKE '2000-01-01T%'",
            one.id);
        if (!row.step()) {
            continue;
        }
        const auto [there, is_new] = first.emplace(one.participant, std::pair(row.text(0), &one));
        if (is_new || there->second.first == row.text(0) ||
            people.in_conflict().contains(one.participant)) {
            continue;
        }
        people.leave_out(one.participant);
        conflicts.push_back(
            {.what = fmt::format("{}: simulated with another secret than session {} of {}: they "
                                 "are two people of one code",
                                 called(one), there->second.second->number,
                                 there->second.second->study_name),
             .first = there->second.second->file,
             .second = one.file,
             .remedy = "simulate one of them again with the --secret of the other, or merge files "
                       "of each secret by themselves"});
    }
}

/// What a session says is what was recorded, by its chain of hashes; if not, that is a conflict.
bool whole(const SessionVersion& session, std::vector<MergeConflict>& conflicts) {
    if (chain_breaks(*session.database, session.id).empty()) {
        return true;
    }
    conflicts.push_back(
        {.what = called(session) +
                 ": it is damaged or was changed since it was recorded; palpate verify says where",
         .first = session.file,
         .second = {},
         .remedy = "give a copy from before that"});
    return false;
}

/// By study, participant and number: shards of one simulation become what it is in one file, row by
/// row.
std::vector<SessionMerge> in_order(const std::map<std::string, Versions>& all,
                                   const Database& out,
                                   const std::string& prefer,
                                   PeopleMerge& people,
                                   MergeReport& report) {
    std::vector<SessionMerge> order;
    for (const auto& [uuid, versions] : all) {
        const SessionVersion& first = versions.front();
        if (const SessionVersion* last = last_of(versions, prefer, people, report.conflicts)) {
            order.push_back({last, first.database == &out ? &first : nullptr});
            for (const SessionVersion& version : versions) {
                if (version.destructions < last->destructions) {
                    people.is_of_before(version.file, last->participant);
                }
            }
        }
    }
    std::ranges::stable_sort(order, {}, [](const SessionMerge& one) {
        return fmt::format("{} {} {:06}", one.last->study, one.last->participant, one.last->number);
    });
    return order;
}

/// What a preference leaves out of the sessions that are merged.
void note_preferred(const std::vector<SessionMerge>& order,
                    const std::map<std::string, Versions>& all,
                    MergeReport& report) {
    for (const SessionMerge& one : order) {
        for (const SessionVersion* other : latest_of(all.at(one.last->uuid))) {
            if (other != one.last) {
                report.notices.push_back(
                    fmt::format("{}: it is as {} has it; what {} has beside that is left out",
                                called(*other), one.last->file, other->file));
            }
        }
    }
}

void bring(const SessionMerge& one, Database& out, const Layout& layout, MergeReport& report) {
    if (one.own == nullptr) {
        add_session(*one.last, out, layout);
        ++report.added;
        return;
    }
    const bool of_it = became(*one.own, *one.last);
    const bool goes_on = of_it && !one.last->destroyed &&  // what was destroyed is so anew
                         one.own->destructions == one.last->destructions;
    (goes_on ? extend_session : replace_session)(*one.last, *one.own, out, layout);
    ++(of_it ? report.extended : report.replaced);
}

void collect(Database& database,
             const std::string& name,
             const Layout& layout,
             PeopleMerge& people,
             std::map<std::string, Versions>& all) {
    people.read(database, name);
    for (SessionVersion& version : session_versions(database, layout, name)) {
        all[version.uuid].push_back(std::move(version));
    }
}

/// Sessions of whom something was destroyed in a file that did not have them: they are left out
/// until it is done where they are. Where that is the file itself, nothing of its person changes,
/// so that it goes on to be one that does not know of it.
void leave_undestroyed(std::vector<SessionMerge>& order,
                       PeopleMerge& people,
                       std::vector<MergeConflict>& conflicts) {
    std::set<std::string> gone;  // of whom all was destroyed
    for (const SessionMerge& one : order) {
        if (one.last->destroyed) {
            gone.insert(one.last->participant);
        }
    }
    std::erase_if(order, [&](const SessionMerge& one) {
        const SessionVersion& session = *one.last;
        const bool all = gone.contains(session.participant);
        const std::string when = people.destroyed_unknown_to(session.file, session.participant);
        if (when.empty() || session.destroyed || (session.destructions > 0 && !all)) {
            return false;
        }
        if (one.own == one.last) {
            people.leave_out(session.participant);
        }
        conflicts.push_back(
            {.what = fmt::format("{}: {} was destroyed on request ({}) in a file without it",
                                 called(session), all ? "everything" : "what was noted", when),
             .first = session.file,
             .second = {},
             .remedy =
                 fmt::format("palpate participant {} {} --destroy {} does it there, too; a "
                             "session run since then comes with --prefer FILE",
                             session.file, session.participant, all ? "everything" : "details")});
        return true;
    });
}

/// A session that a program runs in the file, and would go on from what is not there any more.
bool runs(const SessionMerge& one, std::vector<MergeConflict>& conflicts) {
    if (one.own == nullptr || !SessionLock::held(*one.own->database, one.own->id)) {
        return false;
    }
    conflicts.push_back({.what = called(*one.own) + ": it runs now, and would not hear of it",
                         .first = one.own->file,
                         .second = one.last->file,
                         .remedy = "end it, and merge again"});
    return true;
}

/// What cannot be brought, or is there already.
void leave_out(std::vector<SessionMerge>& order, const PeopleMerge& people, MergeReport& report) {
    const std::set<std::string> twice = doubled(order, report.conflicts);
    std::erase_if(order, [&](const SessionMerge& one) {
        return twice.contains(one.last->uuid) ||
               people.in_conflict().contains(one.last->participant);
    });
    report.same = std::erase_if(order, [](const SessionMerge& one) {
        return one.own == one.last || (one.own != nullptr && became(*one.last, *one.own));
    });
    std::erase_if(order, [&](const SessionMerge& one) { return runs(one, report.conflicts); });
    std::erase_if(order,
                  [&](const SessionMerge& one) { return !whole(*one.last, report.conflicts); });
}

/// @return something of it was destroyed in another file
bool merge_into(Database& out,
                std::deque<Input>& inputs,
                const std::string& prefer,
                MergeReport& report) {
    bool destroyed = false;
    const Layout layout = catalogue_layout();
    PeopleMerge people(prefer);
    std::map<std::string, Versions> all;
    require_trace_columns(out, out.file());
    collect(out, out.file(), layout, people, all);
    for (Input& input : inputs) {
        collect(input.database, input.name, layout, people, all);
    }
    std::vector<SessionMerge> order = in_order(all, out, prefer, people, report);
    part_simulated(order, people, report.conflicts);
    leave_undestroyed(order, people, report.conflicts);
    people.settle();
    std::ranges::copy(people.conflicts(), std::back_inserter(report.conflicts));
    std::ranges::copy(people.notices(), std::back_inserter(report.notices));
    people.write(out);
    destroyed = people.forgot(out.file());
    leave_out(order, people, report);
    note_preferred(order, all, report);
    for (const SessionMerge& one : order) {  // who changes whose it is: numbers for each other
        if (one.own != nullptr) {
            out.run(
                "UPDATE session SET session_number = 1000000 + session_id WHERE session_id = ?1",
                one.own->id);
        }
    }
    for (const SessionMerge& one : order) {
        bring(one, out, layout, report);
        destroyed = destroyed || one.last->destructions > 0;
    }
    for (Input& input : inputs) {
        copy_shared(input.database, out, input.name);
    }
    drop_unused_secrets(out);
    return destroyed;
}

MergeReport merge_all(Database& out, std::deque<Input>& inputs, const std::string& prefer) {
    MergeReport report;
    bool destroyed = false;
    {
        Transaction all_or_nothing(out);
        out.execute("PRAGMA defer_foreign_keys = ON");
        if (!anybody_in(out)) {
            out.execute("DELETE FROM secret");  // it has those of the others
        }
        destroyed = merge_into(out, inputs, prefer, report);
        all_or_nothing.commit();
    }
    destroyed ? empty_free_pages(out) : out.checkpoint();
    return report;
}

}  // namespace

MergeReport merge_files(const std::string& file,
                        const std::vector<std::string>& files,
                        const std::string& prefer) {
    std::deque<Input> inputs;
    for (const std::string& name : files) {
        inputs.emplace_back(name);  // before anything is made
    }
    Database out(file, Access::write);
    try {
        return merge_all(out, inputs, prefer);
    } catch (const StoreError&) {
        out.take_back();
        throw;
    }
}

}  // namespace palpate::data
