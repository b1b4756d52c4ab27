#include "tests/support/lab_files.hpp"

using namespace palpate::data;

namespace {

/// Relative names are of files in here.
class WorkingFolder {
public:
    explicit WorkingFolder(const std::filesystem::path& folder) {
        std::filesystem::current_path(folder);
    }
    WorkingFolder(const WorkingFolder&) = delete;
    WorkingFolder& operator=(const WorkingFolder&) = delete;
    ~WorkingFolder() { std::filesystem::current_path(before_); }

private:
    std::filesystem::path before_ = std::filesystem::current_path();
};

/// Somebody's database with a log that is not yet in the file, as a program leaves it that was
/// killed.
/// @param checkpointed  whether tables are in the file already, or all of it is in the log
/// @param journal       DELETE: there is no log
void make_foreign(const std::string& file, bool checkpointed, const std::string& journal) {
    ended(Process({"sqlite3", "-cmd", ".dbconfig no_ckpt_on_close on", file,
                   "PRAGMA journal_mode = " + journal + "; CREATE TABLE theirs (x);" +
                       (checkpointed ? "PRAGMA wal_checkpoint(TRUNCATE);" : "") +
                       "INSERT INTO theirs VALUES (1), (2), (3)"})
              .wait());
}

}  // namespace

TEST_CASE("somebody's database is refused, and it and a log beside it stay byte for byte") {
    const std::string journal = GENERATE("WAL", "DELETE");
    const bool checkpointed = GENERATE(true, false);
    const Access access = GENERATE(Access::write, Access::read);
    CAPTURE(journal, checkpointed, access == Access::write);
    const TemporaryFile file("theirs.sqlite");
    make_foreign(file, checkpointed, journal);
    const std::string data = slurp(file);
    const std::string log = slurp(file + "-wal");
    REQUIRE(log.empty() == (journal == "DELETE"));

    CHECK_THROWS_WITH(Database(file, access), Has("theirs.sqlite", "not a palpate database"));

    CHECK(slurp(file) == data);
    CHECK(slurp(file + "-wal") == log);
    CHECK(lab_sqlite(file, "SELECT count(*) FROM theirs") == "3\n");
}

TEST_CASE("a file of somebody's is refused and stays, however small it is") {
    const TemporaryFolder folder;
    const std::string file = folder.file("note");
    for (const std::size_t size : {1U, 2U, 15U, 16U, 99U, 100U, 101U, 512U, 4096U, 5000U}) {
        CAPTURE(size);
        const std::string text(size, 'x');
        std::ofstream(file, std::ios::trunc) << text;
        CHECK_THROWS_WITH(Database(file, Access::write),
                          Has("note", "not a palpate database", "choose another file name"));
        CHECK(slurp(file) == text);
    }
    CHECK(folder.names() == Words{"note"});
}

TEST_CASE("a database has the name it was given, whatever that name means to SQLite") {
    const std::string name =
        GENERATE(as<std::string>(), ":memory:", "file:a.sqlite", "file:b?mode=memory",
                 "file::memory:?cache=shared", "-c", "a b.sqlite", "%41.sqlite", "a?immutable=1");
    CAPTURE(name);
    const TemporaryFolder folder;
    const WorkingFolder here(folder.path());
    sql_edit(name, "INSERT INTO participant (participant_code, subject) VALUES ('P1', 1)");
    CHECK(folder.names() == Words{name});
    CHECK(sql_first(name, "SELECT participant_code FROM participant") == "P1");
}

TEST_CASE("a database without a name is refused with a sentence, and leaves nothing") {
    const Access access = GENERATE(Access::write, Access::read);
    const TemporaryFolder folder;
    const WorkingFolder here(folder.path());
    CHECK_THROWS_WITH(Database("", access), Has("give a file name"));
    CHECK(folder.names().empty());
}

TEST_CASE("a folder in place of a database is called a folder") {
    const Access access = GENERATE(Access::write, Access::read);
    const TemporaryFolder folder;
    CHECK_THROWS_WITH(Database(folder.path().string(), access), Has("is a folder"));
}
