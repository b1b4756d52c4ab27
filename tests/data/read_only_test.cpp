#include <sys/stat.h>

#include "data/analysis/summary.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child.hpp"
#include "tests/support/studies.hpp"

using namespace palpate::data;

namespace {

/// What the database says of itself.
std::string contents(Database& database) {
    return data::summary_text(database) + content_hash(database);
}

std::string contents(const std::string& file) {
    Database database(file, Access::read);
    return contents(database);
}

/// A session with one answered trial in `file`. The rig has ended: no log is beside it.
std::string record(const std::string& file) {
    Database database(file, Access::write);
    const auto spec = session_spec(small_protocol());
    const auto opened = data::open_session(database, spec);
    data::SqliteRecorder recorder(database, spec.protocol, opened.id);
    const auto id = begin_trial(recorder, spec.protocol, spec.plan.trials[0]);
    recorder.append(id, random_ticks(1, 300));
    recorder.end_trial(id, answered(0, true, 300));
    return contents(database);
}

/// Takes the right to write away from the folder and all in it, for as long as this lives.
class Locked {
public:
    explicit Locked(const TemporaryFolder& folder) : folder_(folder.path()) {
        for (const std::string& name : folder.names()) {
            chmod(folder.file(name).c_str(), 0444);
        }
        chmod(folder_.c_str(), 0555);
    }
    Locked(const Locked&) = delete;
    Locked& operator=(const Locked&) = delete;
    ~Locked() { chmod(folder_.c_str(), 0755); }

private:
    std::filesystem::path folder_;
};

/// What `work` returns in another process, which then ends as if it were killed.
template <class Work>
std::string in_child(const Work& work) {
    int ends[2];
    REQUIRE(pipe(ends) == 0);
    const pid_t child = in_a_child([&] {
        close(ends[0]);
        std::string text;
        try {
            text = work();
        } catch (const std::exception& e) {
            text = std::string("thrown: ") + e.what();
        }
        static_cast<void>(!::write(ends[1], text.data(), text.size()));
    });
    close(ends[1]);
    std::string text;
    char byte = 0;
    while (read(ends[0], &byte, 1) == 1) {
        text += byte;
    }
    close(ends[0]);
    waitpid(child, nullptr, 0);
    return text;
}

/// The same, by somebody whom permissions bind: root becomes nobody first.
template <class Work>
std::string without_rights(const Work& work) {
    constexpr uid_t kNobody = 65534;
    return in_child([&]() -> std::string {
        if (geteuid() == 0 && setresuid(kNobody, kNobody, kNobody) != 0) {
            return "permissions bind nobody here";
        }
        return work();
    });
}

std::string hash_of(const std::string& file) {
    Database database(file, Access::read);
    return content_hash(database);
}

/// Records into `file` and is killed in the middle of a trial. Most is in the log only.
/// @returns the content hash at the end
std::string record_and_die(const std::string& file) {
    return in_child([&] {
        auto& rig = *new Database(file, Access::write);  // nothing is closed
        const auto spec = session_spec(small_protocol());
        const auto opened = data::open_session(rig, spec);
        data::SqliteRecorder recorder(rig, spec.protocol, opened.id);
        recorder.append(begin_trial(recorder, spec.protocol, spec.plan.trials[0]),
                        random_ticks(1, 512));
        recorder.save();
        return content_hash(rig);
    });
}

/// What this process does is done by another user, for as long as this lives.
class As {
public:
    explicit As(uid_t user) { REQUIRE(seteuid(user) == 0); }
    As(const As&) = delete;
    As& operator=(const As&) = delete;
    ~As() { REQUIRE(seteuid(0) == 0); }
};

constexpr uid_t kAlice = 60'001;
constexpr uid_t kBob = 60'002;

/// A file of Alice's where everybody may make files, and Bob may read; empty: only root can.
std::string alices(const TemporaryFolder& folder) {
    if (geteuid() != 0) {
        WARN("only root is two users: not checked");
        return "";
    }
    chmod(folder.path().c_str(), 01777);
    const As alice(kAlice);
    static_cast<void>(record(folder.file("a.sqlite")));
    chmod(folder.file("a.sqlite").c_str(), 0644);
    return folder.file("a.sqlite");
}

bool permissions_bind(const TemporaryFolder& folder) {
    const std::string can = without_rights(
        [&] { return std::string(access(folder.path().c_str(), W_OK) == 0 ? "yes" : "no"); });
    const bool reached =
        without_rights([&] {
            return std::string(access(folder.path().c_str(), X_OK) == 0 ? "yes" : "no");
        }) == "yes";
    if (can != "no" || !reached) {
        WARN("permissions do not bind this user, or its temporary folder is closed: not checked");
        return false;
    }
    return true;
}

}  // namespace

TEST_CASE("a database in a folder that cannot be written is read as anywhere else") {
    EACH(looked_at, false, true);  // a reader leaves an empty log and its index
    const TemporaryFolder folder;
    const std::string file = folder.file("a b%41.sqlite");  // a name that a URI has to spell out
    const std::string recorded = record(file);
    if (looked_at) {
        CHECK(contents(file) == recorded);
    }
    const auto names = folder.names();
    const Locked locked(folder);
    if (!permissions_bind(folder)) {
        return;
    }
    CHECK(without_rights([&] { return contents(file); }) == recorded);
    CHECK(folder.names() == names);
}

// SQLite keeps the log beside the file, not beside the link.
TEST_CASE("what a killed rig has only in its log is seen in a locked folder, and through a link") {
    const TemporaryFolder folder;
    const std::string file = folder.file("a.sqlite");
    const std::string hash = record_and_die(file);
    REQUIRE(std::filesystem::file_size(file + "-wal") > 0);
    const TemporaryFolder links;
    std::filesystem::create_symlink(file, links.file("b.sqlite"));
    chmod(links.path().c_str(), 0555);
    const Locked locked(folder);
    if (!permissions_bind(folder) || !permissions_bind(links)) {
        return;
    }
    CHECK(without_rights([&] { return hash_of(file); }) == hash);
    CHECK(without_rights([&] { return hash_of(links.file("b.sqlite")); }) == hash);
}

TEST_CASE("a rig whose folder cannot be written hears so") {
    const TemporaryFolder folder;
    static_cast<void>(record(folder.file("a.sqlite")));
    const Locked locked(folder);
    if (!permissions_bind(folder)) {
        return;
    }
    CHECK_THAT(without_rights([&] {
                   Database database(folder.file("a.sqlite"), Access::write);
                   return std::string("opened");
               }),
               Has("a.sqlite", "read-only"));
}

TEST_CASE("who reads a file of another's leaves nothing beside it that would lock its owner out") {
    const TemporaryFolder folder;
    const std::string file = alices(folder);
    if (file.empty()) {
        return;
    }
    const std::string recorded = contents(file);
    EACH(log, "", "an empty log", "its index");
    std::filesystem::remove(file + "-wal");
    std::filesystem::remove(file + "-shm");
    if (*log != '\0') {
        std::ofstream(file + (std::string(log) == "its index" ? "-shm" : "-wal"));
    }
    const auto before = folder.names();
    {
        const As bob(kBob);
        CHECK(contents(file) == recorded);
    }
    CHECK(folder.names() == before);
    std::filesystem::remove(file + "-wal");
    std::filesystem::remove(file + "-shm");
    const As alice(kAlice);
    Database(file, Access::write).execute("UPDATE participant SET handedness = 20");
}

TEST_CASE(
    "who reads a file of another's while it is written hears so, and reads the new one then") {
    const TemporaryFolder folder;
    const std::string file = alices(folder);
    if (file.empty()) {
        return;
    }
    const auto writes = [&](const char* sql) {
        const As alice(kAlice);
        Database(file, Access::write).execute(sql);  // into the file, as it ends
    };
    constexpr const char* kHandedness = "SELECT handedness FROM participant";
    std::unique_ptr<Database> reader;
    {
        const As bob(kBob);
        reader = std::make_unique<Database>(file, Access::read);
        CHECK(reader->first(kHandedness).null(0));
    }
    writes("UPDATE participant SET handedness = 20");
    CHECK_THROWS_WITH(reader->first(kHandedness), Has("a.sqlite", "written to while it was read"));
    const As bob(kBob);
    CHECK(Database(file, Access::read).first(kHandedness).integer(0) == 20);
}

TEST_CASE("what another user's program left beside a file is said, and what to do") {
    const TemporaryFolder folder;
    const std::string file = alices(folder);
    if (file.empty()) {
        return;
    }
    for (const char* beside : {"-wal", "-shm"}) {
        std::ofstream(file + beside);
        chmod((file + beside).c_str(), 0600);
        REQUIRE(chown((file + beside).c_str(), kBob, kBob) == 0);
    }
    const As alice(kAlice);
    for (const Access access : {Access::read, Access::write}) {
        CHECK_THROWS_WITH(
            Database(file, access),
            Has("belongs to user 60002", "chown $USER " + file + "-wal " + file + "-shm"));
    }
}

TEST_CASE("the index of another's log is not made for them") {
    const TemporaryFolder folder;
    const std::string file = alices(folder);
    if (file.empty()) {
        return;
    }
    std::ofstream(file + "-wal") << "something";
    const auto names = folder.names();
    {
        const As bob(kBob);
        CHECK_THROWS_WITH(Database(file, Access::read), Has("would keep the file's owner from"));
    }
    CHECK(folder.names() == names);
}
