#include <fmt/ranges.h>

#include "engine/base/files.hpp"
#include "protocols/design/session_plan.hpp"
#include "data/export/export.hpp"
#include "data/sync/merge.hpp"
#include "tests/power/watched_session.hpp"
#include "tests/support/catch.hpp"

using namespace palpate::data;

namespace fs = std::filesystem;

namespace {

/// Does `work` in a folder, and checks what a power cut at any of its calls leaves there, in so
/// many ways.
/// @param check  of the folder left, and whether the work had come back before
void cut_everywhere(const TemporaryFolder& folder,
                    const std::function<void()>& work,
                    const std::function<void(const TemporaryFolder&, bool)>& check,
                    std::size_t ways = std::size(kLeaves),
                    std::size_t step = 1) {
    WatchedDisk disk(folder.path());
    work();
    const std::size_t done = disk.calls();
    disk.stop();
    REQUIRE(done > 3);
    DiskModel model = disk.before();
    for (std::size_t cut = 0; cut <= done; ++cut) {
        const bool looked_at = cut % step == 0 || cut == done;
        for (std::size_t i = 0; looked_at && i < ways; ++i) {
            const Leaves leaves = kLeaves[(cut + i) % std::size(kLeaves)];
            CAPTURE(cut, done, static_cast<int>(leaves));
            Random random(cut);
            const TemporaryFolder left;
            model.lay_out(leaves, random, left.path());
            const WatchedDisk unsynced(left.path());
            check(left, cut == done);
        }
        if (cut < done) {
            model.apply(disk.log()[cut]);
        }
    }
}

std::string a_session(const std::string& file, const std::string& participant) {
    data::SessionSpec spec = short_session(false);
    spec.plan = protocols::make_plan(spec.protocol, spec.protocol_hash, {participant, 1, kSecret},
                                     spec.seed);
    spec.key = {participant, 1, kSecret};
    Database database(file, Access::write);
    CHECK(run_simulated(database, spec).why == protocols::SessionEnd::Why::finished);
    return file;
}

std::string hash_of(const std::string& file) {
    Database database(file, Access::read);
    return content_hash(database);
}

}  // namespace

TEST_CASE(
    "a power cut while files are merged leaves a whole file, and merging again gives the same",
    "[long]") {
    EACH(there, false, true);
    const TemporaryFolder inputs;
    const TemporaryFolder folder;
    Words files;
    {
        const WatchedDisk unsynced(inputs.path());
        for (const char* who : {"P1", "P2"}) {
            files.push_back(a_session(inputs.file(std::string(who) + ".sqlite"), who));
        }
        if (there) {
            a_session(folder.file("all.sqlite"), "P3");
        }
    }
    std::string whole;
    const auto work = [&] {
        static_cast<void>(data::merge_files(folder.file("all.sqlite"), files));
    };
    const std::string before = there ? hash_of(folder.file("all.sqlite")) : "";
    {
        const TemporaryFolder other;
        if (there) {
            fs::copy(folder.file("all.sqlite"), other.file("all.sqlite"));
        }
        static_cast<void>(data::merge_files(other.file("all.sqlite"), files));
        whole = hash_of(other.file("all.sqlite"));
    }
    cut_everywhere(
        folder, work,
        [&](const TemporaryFolder& left, bool done) {
            const std::string file = left.file("all.sqlite");
            if (there) {
                const std::string now = hash_of(file);
                CHECK((now == whole || (!done && now == before)));
            }
            const auto report = data::merge_files(file, files);
            CHECK(report.conflicts.empty());
            CHECK((!done || report.same == (there ? 3U : 2U)));
            CHECK(hash_of(file) == whole);
            Database database(file, Access::read);
            CHECK(lines(database, "PRAGMA integrity_check") == "ok \n");
        },
        1, 2);
}

TEST_CASE("a power cut during an export leaves the whole folder under its name, or none") {
    const TemporaryFolder input;
    const std::string file = a_session(input.file("a.sqlite"), "P1");
    const auto format = GENERATE(data::ExportFormat::csv, data::ExportFormat::bids);
    data::ExportOptions options;
    options.kind = "all";
    options.traces = true;
    const TemporaryFolder folder;
    const auto work = [&] {
        data::export_file(file, format, options, folder.path() / "out");
    };
    cut_everywhere(folder, work, [&](const TemporaryFolder& left, bool done) {
        const bool is_there = fs::exists(left.path() / "out");
        CHECK((is_there || !done));
        CHECK((!is_there || everything(left.path() / "out") == everything(folder.path() / "out")));
    });
}

TEST_CASE(
    "a file that was said to be written is whole after a power cut, and one written over is never "
    "half") {
    const TemporaryFolder folder;
    const std::string first = "x\n" + std::string(20'000, 'a');
    const std::string second = "x\n" + std::string(30'000, 'b');
    write_whole(folder.file("out.csv"), first);
    const auto work = [&] {
        write_whole(folder.file("out.csv"), second);
        write_new(folder.file("new.toml"), second);
    };
    cut_everywhere(folder, work, [&](const TemporaryFolder& left, bool done) {
        const std::string text = slurp(left.file("out.csv"));
        CHECK((text == second || (!done && text == first)));
        CHECK((!done || slurp(left.file("new.toml")) == second));
    });
}
