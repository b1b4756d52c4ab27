#pragma once

#include "tests/support/program.hpp"
#include "tests/support/sql_first.hpp"

/// Finished sessions' files, and what others do to them.
namespace palpate::tests {

/// By another program: nothing of palpate takes part.
inline std::string lab_sqlite(const std::string& file, const std::string& sql) {
    const Finished done =
        tests::Process({"sqlite3", "-cmd", ".dbconfig defensive off", file, sql}).wait();
    CAPTURE(sql, done.error);
    REQUIRE(done.code == 0);
    return done.out.substr(done.out.find("off\n") + 4);  // after the word of .dbconfig
}

/// Of a finished session; a copy of it with `sql` done to it.
class LabFiles {
public:
    LabFiles() { ran({"demo", "--headless", "--db", clean}); }
    [[nodiscard]] std::string with(const std::string& sql) const {
        std::string file = copied(clean, folder.file("copy.sqlite"));
        lab_sqlite(file, sql);
        return file;
    }
    [[nodiscard]] Words run(const std::string& file, const std::string& who) const {
        return {"run", "shape_friction_demo", "--participant", who, "--db",
                file,  "--headless",          "--speed",       "0"};
    }

    TemporaryFolder folder;
    std::string clean = folder.file("clean.sqlite");
};

}  // namespace palpate::tests
