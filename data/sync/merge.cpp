#include "data/sync/merge.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>

#include <fmt/format.h>

#include "data/store/chain.hpp"
#include "data/sync/people_merge.hpp"
#include "data/sync/session_copy.hpp"
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

using Versions = std::vector<SessionVersion>;

std::string called(const SessionVersion& session) {
    return fmt::format("{}, participant {}, session {} ({})", session.study_name,
                       session.participant, session.number, session.uuid);
}

/// The version that all others became; none if two of them differ, which is a conflict.
const SessionVersion* last_of(const Versions& versions, std::vector<MergeConflict>& conflicts) {
    const SessionVersion* last = &versions.front();
    for (const SessionVersion& version : versions) {
        if (became(version, *last)) {
            continue;
        }
        if (!became(*last, version)) {
            conflicts.push_back({.what = called(version) + ": what was recorded differs",
                                 .first = last->file,
                                 .second = version.file});
            return nullptr;
        }
        last = &version;
    }
    return last;
}

/// One study, participant and number can only be one session.
std::set<std::string> doubled(const std::map<std::string, Versions>& all,
                              std::vector<MergeConflict>& conflicts) {
    std::map<std::string, const SessionVersion*> first;
    std::set<std::string> found;
    for (const auto& [uuid, versions] : all) {
        const SessionVersion& one = versions.front();
        const auto [there, is_new] =
            first.emplace(fmt::format("{} {} {}", one.study, one.participant, one.number), &one);
        if (!is_new) {
            found.insert(uuid);
            found.insert(there->second->uuid);
            conflicts.push_back({.what = fmt::format("{}: another session of the same number is {}",
                                                     called(one), there->second->uuid),
                                 .first = there->second->file,
                                 .second = one.file});
        }
    }
    return found;
}

/// What a session says is what was recorded, by its chain of hashes; if not, that is a conflict.
bool whole(const SessionVersion& session, std::vector<MergeConflict>& conflicts) {
    if (chain_breaks(*session.database, session.id).empty()) {
        return true;
    }
    conflicts.push_back({.what = called(session) +
                                 ": it is damaged or was changed since it was recorded; palpate "
                                 "verify says where",
                         .first = session.file,
                         .second = {}});
    return false;
}

/// By study, participant and number: shards of one simulation become what it is in one file, row by row.
std::set<std::pair<std::string, std::string>> in_order(const std::map<std::string, Versions>& all) {
    std::set<std::pair<std::string, std::string>> order;
    for (const auto& [uuid, versions] : all) {
        const SessionVersion& one = versions.front();
        order.emplace(fmt::format("{} {} {:06}", one.study, one.participant, one.number), uuid);
    }
    return order;
}

std::vector<std::unique_ptr<Input>> open_all(const std::vector<std::string>& files) {
    std::vector<std::unique_ptr<Input>> inputs;
    for (const std::string& file : files) {
        inputs.push_back(std::make_unique<Input>(file));
    }
    return inputs;
}

}  // namespace

MergeReport merge_files(const std::string& file, const std::vector<std::string>& files) {
    const auto inputs = open_all(files);  // before anything is made
    std::error_code unknown;
    const bool is_new = !std::filesystem::exists(file, unknown);
    Database out(file, Access::write);
    MergeReport report;
    Transaction all_or_nothing(out);
    out.execute("PRAGMA defer_foreign_keys = ON");
    if (is_new) {
        out.execute("DELETE FROM secret");  // it has those of the others
    }
    const Layout layout = read_layout(out);

    PeopleMerge people;
    std::map<std::string, Versions> all;
    std::map<std::string, const SessionVersion*> there;
    const auto collect = [&](Database& database, const std::string& name) {
        people.read(database, name);
        for (SessionVersion& version : session_versions(database, layout, name)) {
            all[version.uuid].push_back(std::move(version));
        }
    };
    collect(out, file);
    for (const auto& input : inputs) {
        collect(input->database, input->name);
    }
    people.number();
    report.conflicts = people.conflicts();
    people.write(out);
    const std::set<std::string> twice = doubled(all, report.conflicts);
    for (const auto& [order, uuid] : in_order(all)) {
        const Versions& versions = all.at(uuid);
        const SessionVersion* last = last_of(versions, report.conflicts);
        const SessionVersion* own = versions.front().database == &out ? &versions.front() : nullptr;
        if (last == nullptr || twice.contains(uuid) ||
            people.in_conflict().contains(last->participant)) {
            continue;
        }
        if (own == last || (own != nullptr && became(*last, *own))) {
            ++report.same;
        } else if (!whole(*last, report.conflicts)) {
            continue;
        } else if (own != nullptr) {
            extend_session(*last, *own, out, layout);
            ++report.extended;
        } else {
            add_session(*last, out, layout);
            ++report.added;
        }
    }
    for (const auto& input : inputs) {
        copy_shared(input->database, out, layout, input->name);
    }
    all_or_nothing.commit();
    out.checkpoint();
    return report;
}

}  // namespace palpate::data
