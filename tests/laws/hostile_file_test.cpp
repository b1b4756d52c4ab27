#include <filesystem>
#include <string>
#include <vector>

#include <sys/stat.h>

#include "data/store/database.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/process.hpp"

using namespace palpate;
using Catch::Matchers::ContainsSubstring;
using tests::Finished;
using tests::palpate_command;
using tests::TemporaryFolder;

namespace {

/// Of a finished session.
class Files {
public:
    Files() {
        REQUIRE(palpate_command({"demo", "--headless", "--db", clean}).code == 0);
        data::Database(clean, data::Access::write).checkpoint();
    }

    TemporaryFolder folder;
    std::string clean = folder.file("clean.sqlite");
};

}  // namespace

TEST_CASE("written files follow no link, what holds codes is its owner's, and leftovers go",
          "[export][law]") {
    const Files files;
    const auto rights = [](const std::string& file) {
        struct stat status {};
        REQUIRE(stat(file.c_str(), &status) == 0);
        return status.st_mode & 0777U;
    };
    const std::string shared = files.folder.file("shared");
    const std::string left = shared + ".palpate-part-aBcD12";
    std::filesystem::create_directory(left);
    tests::write(left + "/trials.csv", "subject");
    const std::string near = shared + ".palpate-part-another";
    tests::write(near, "");
    const Finished plain = palpate_command({"export", files.clean, "--kind", "all", "-o", shared});
    CHECK(plain.code == 0);
    CHECK_THAT(plain.error, ContainsSubstring("aBcD12") && ContainsSubstring("it is removed"));
    CHECK(!std::filesystem::exists(left));
    CHECK(std::filesystem::exists(near));
    CHECK((rights(shared + "/trials.csv") & 0044U) != 0);
    const std::string coded = files.folder.file("coded");
    CHECK(palpate_command({"export", files.clean, "--kind", "all", "--keep-codes", "-o", coded})
              .code == 0);
    CHECK(rights(coded + "/codes.csv") == 0600);
    const std::string page = files.folder.file("r.html");
    CHECK(
        palpate_command({"report", files.clean, "--trial", "1", "--keep-codes", "-o", page}).code ==
        0);
    CHECK(rights(page) == 0600);
    // Whoever may write in the folder knows the process, and lays a link where it would write.
    const std::string victim = files.folder.file("victim");
    tests::write(victim, "mine");
    const Finished linked =
        tests::Process(
            {"sh", "-c",
             "ln -s \"$2\" \"$3.$$.part\"; exec \"$0\" report \"$1\" --trial 1 -o \"$3\"",
             tests::palpate_program(), files.clean, victim, page})
            .wait();
    CAPTURE(linked.error);
    CHECK(linked.code == 0);
    CHECK(std::filesystem::file_size(victim) == 4);
    for (const char* code : {"--help", "-rf", "_a"}) {
        const Finished refused = palpate_command(
            {"run", "shape_friction_demo", std::string("--participant=") + code, "--db",
             files.folder.file("new.sqlite"), "--headless", "--speed", "0"});
        CHECK(refused.code == 2);
        CHECK_THAT(refused.error, ContainsSubstring("the first a letter or digit"));
    }
}
