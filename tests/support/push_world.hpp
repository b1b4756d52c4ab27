#pragma once

#include "data/sync/postgres.hpp"
#include "tests/support/postgres_server.hpp"
#include "tests/support/program.hpp"

/// What tests of push share: a server, a file, and what is on the server.
namespace palpate::tests {

/// Whether this palpate can talk to PostgreSQL at all; says so where not.
inline bool has_libpq() {
    try {
        const data::Postgres nobody("postgresql://u@127.0.0.1:1/d");
    } catch (const std::invalid_argument& e) {
        WARN("skipped: " << e.what());
        return false;
    } catch (const data::PostgresError&) {  // nobody answers there
    }
    return true;
}

/// A server, or nothing and a word why not.
inline std::unique_ptr<PostgresServer> a_server(const std::string& certificate = {},
                                                const std::string& key = {}) {
    if (!has_libpq()) {
        return nullptr;
    }
    auto server = PostgresServer::start(certificate, key);
    if (!server) {
        WARN("skipped: no PostgreSQL server is installed (Debian: postgresql)");
    }
    return server;
}

/// In a test case: `server` is one, or the case ends with a word why there is none.
#define A_SERVER(server, ...)                  \
    const auto server = a_server(__VA_ARGS__); \
    if (!(server)) {                           \
        return;                                \
    }

inline std::string a_database(const TemporaryFolder& folder) {
    const std::string file = folder.file("demo.sqlite");
    ran({"demo", "--headless", "--db", file});
    return file;
}

/// A server, and a file that lies in a folder.
#define A_SERVER_AND_FILE(server, folder, file) \
    A_SERVER(server);                           \
    const TemporaryFolder folder;               \
    const std::string file = a_database(folder)

inline Finished pushed(const std::string& file, const std::string& url, const Words& more = {}) {
    return palpate_command(joined({"push", file, "--to", url}, more));
}

/// The first value that a server SELECTs.
inline std::string told(const std::string& url, const std::string& what) {
    return data::Postgres(url).rows("SELECT " + what).at(0).at(0).value();
}
inline const std::string kSessions = "count(*) FROM palpate.session";

/// Number and hash of the rows of each table.
inline std::string content(const std::string& url) {
    data::Postgres server(url);
    std::string all;
    for (const auto& table : server.rows(
             "SELECT relname FROM pg_class JOIN pg_namespace ON pg_namespace.oid = relnamespace"
             " WHERE nspname = 'palpate' AND relkind = 'r' ORDER BY relname")) {
        const auto hash = server.rows(fmt::format(
            "SELECT count(*) || ' ' || coalesce(md5(string_agg(t::text, '' ORDER BY t::text)), '-')"
            " FROM palpate.\"{}\" AS t",
            *table[0]));
        all += *table[0] + ' ' + *hash[0][0] + '\n';
    }
    return all;
}

inline std::string new_database(const PostgresServer& server, const std::string& name) {
    data::Postgres(server.url()).run("CREATE DATABASE " + name);
    return server.url(name);
}

}  // namespace palpate::tests
