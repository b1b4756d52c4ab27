#include "data/sync/postgres.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>
#include <memory>
#include <ranges>

#include <fmt/format.h>

#include "engine/base/refuse.hpp"
#include "engine/base/shared_library.hpp"
#include "data/export/csv_export.hpp"

namespace palpate::data {
namespace {

using Oid = unsigned;
constexpr Oid kBytea = 17;

// Of libpq-fe.h; values of its enumerations never change.
struct PGconn;
struct PGresult;
constexpr int kConnectionOk = 0;
constexpr int kCommandOk = 1;
constexpr int kTuplesOk = 2;
constexpr int kPipelineSync = 10;
constexpr int kPipelineAborted = 11;

/// libpq, PostgreSQL's C library (https://www.postgresql.org/docs/current/libpq.html), loaded when
/// the first server is asked for: it brings twenty libraries, and no other command needs one of
/// them.
struct Libpq {
    static constexpr const char* kFile = "libpq.so.5";
    static constexpr const char* kUse =
        "palpate push needs PostgreSQL's library, of version 14 or later";
    static constexpr const char* kPackage = "libpq5";
};
template <class Function>
using Late = LateFunction<Libpq, Function>;

constinit const Late<void(PGresult*)> PQclear("PQclear");
constinit const Late<char*(PGresult*)> PQcmdTuples("PQcmdTuples");
constinit const Late<PGconn*(const char*)> PQconnectdb("PQconnectdb");
constinit const Late<void*(PGconn*)> PQconninfo("PQconninfo");
constinit const Late<PGconn*(const char*)> PQconnectStart("PQconnectStart");
constinit const Late<int(PGconn*)> PQsslInUse("PQsslInUse");
constinit const Late<const char*(PGconn*, const char*)> PQsslAttribute("PQsslAttribute");
constinit const Late<void(void*)> PQconninfoFree("PQconninfoFree");
constinit const Late<void*(const char*, char**)> PQconninfoParse("PQconninfoParse");
constinit const Late<int(PGconn*)> PQenterPipelineMode("PQenterPipelineMode");
constinit const Late<char*(const PGconn*)> PQerrorMessage("PQerrorMessage");
constinit const Late<PGresult*(PGconn*, const char*)> PQexec("PQexec");
constinit const Late<PGresult*(
    PGconn*, const char*, int, const Oid*, const char* const*, const int*, const int*, int)>
    PQexecParams("PQexecParams");
constinit const Late<int(PGconn*)> PQexitPipelineMode("PQexitPipelineMode");
constinit const Late<void(PGconn*)> PQfinish("PQfinish");
constinit const Late<PGresult*(PGconn*)> PQgetResult("PQgetResult");
constinit const Late<int(const PGresult*, int, int)> PQgetisnull("PQgetisnull");
constinit const Late<char*(const PGresult*, int, int)> PQgetvalue("PQgetvalue");
constinit const Late<char*(const PGconn*)> PQhost("PQhost");
constinit const Late<int(const PGresult*)> PQnfields("PQnfields");
constinit const Late<int(const PGresult*)> PQntuples("PQntuples");
constinit const Late<char*(const PGconn*)> PQpass("PQpass");
constinit const Late<int(PGconn*)> PQpipelineSync("PQpipelineSync");
constinit const Late<char*(const PGresult*)> PQresultErrorMessage("PQresultErrorMessage");
constinit const Late<int(const PGresult*)> PQresultStatus("PQresultStatus");
constinit const Late<
    int(PGconn*, const char*, int, const Oid*, const char* const*, const int*, const int*, int)>
    PQsendQueryParams("PQsendQueryParams");
constinit const Late<void*(PGconn*, void (*)(void*, const char*), void*)> PQsetNoticeProcessor(
    "PQsetNoticeProcessor");
constinit const Late<int(const PGconn*)> PQstatus("PQstatus");

PGconn* of(const auto& connection) {
    return static_cast<PGconn*>(connection.get());
}

struct Clear {
    void operator()(PGresult* result) const { PQclear(result); }
};
using Result = std::unique_ptr<PGresult, Clear>;

bool is_good(const Result& result) {
    const int status = PQresultStatus(result.get());
    return status == kCommandOk || status == kTuplesOk;
}

struct ConninfoOption {
    const char *keyword, *variable, *compiled, *value, *label, *shown;
    int size;
};

/// A word of the connection as libpq has it: from the URL, a service file, a variable, or by
/// itself.
std::string word_of(PGconn* connection, std::string_view keyword) {
    auto* all = static_cast<ConninfoOption*>(PQconninfo(connection));
    std::string value;
    for (const ConninfoOption* one = all; one != nullptr && one->keyword != nullptr; ++one) {
        if (one->keyword == keyword && one->value != nullptr) {
            value = one->value;
        }
    }
    PQconninfoFree(all);
    return value;
}

/// This machine: a socket, or an address that goes no further.
bool stays_here(std::string_view host) {
    constexpr std::string_view kName = "localhost";  // in any letters
    return host.empty() || host.front() == '/' || host.front() == '@' ||
           std::ranges::equal(host, kName, {}, [](unsigned char c) { return std::tolower(c); }) ||
           host == "::1" ||
           (host.starts_with("127.") &&
            host.find_first_not_of("0123456789.") == std::string_view::npos);
}

/// The places of a list with commas, one at least.
std::vector<std::string> list_of(const std::string& words) {
    std::vector<std::string> all;
    for (const auto& place : std::views::split(words, ',')) {
        all.emplace_back(place.begin(), place.end());
    }
    return all.empty() ? std::vector<std::string>(1) : all;
}

/// Looked at before a word is sent: of several hosts each.
void require_secure(PGconn* connection) {
    const auto addresses = list_of(word_of(connection, "hostaddr"));
    const auto hosts = list_of(word_of(connection, "host"));
    const std::string mode = word_of(connection, "sslmode");
    for (std::size_t i = 0; i < std::max(addresses.size(), hosts.size()); ++i) {
        // libpq goes by an address, and where its place is empty by the host's name.
        const bool by_name = i >= addresses.size() || addresses[i].empty();
        const std::string host = !by_name ? addresses[i] : i < hosts.size() ? hosts[i] : "";
        refuse_if(
            !stays_here(host) && mode != "verify-full",
            "{} is another machine, and with sslmode={} others can read what is sent, or answer in "
            "its place: give sslmode=verify-full with sslrootcert, or --insecure as well",
            host, mode);
    }
}

std::string text_of(const ColumnValue& value) {
    struct Visitor {
        std::string operator()(std::monostate) const { return {}; }
        std::string operator()(std::int64_t whole) const { return fmt::format("{}", whole); }
        std::string operator()(double real) const { return number_text(real); }
        std::string operator()(const std::string& text) const { return text; }
        std::string operator()(std::span<const std::byte> bytes) const {
            return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
        }
    };
    return std::visit(Visitor{}, value);
}

/// A row as libpq asks for it.
struct Parameters {
    explicit Parameters(const PostgresRow& row) {
        std::ranges::transform(row, std::back_inserter(texts), text_of);
        for (std::size_t i = 0; i < row.size(); ++i) {
            const bool binary = std::holds_alternative<std::span<const std::byte>>(row[i]);
            const bool null = std::holds_alternative<std::monostate>(row[i]);
            values.push_back(null ? nullptr : texts[i].data());
            lengths.push_back(static_cast<int>(texts[i].size()));
            formats.push_back(binary ? 1 : 0);
            types.push_back(binary ? kBytea : 0);
        }
    }

    std::vector<std::string> texts;
    std::vector<const char*> values;
    std::vector<int> lengths, formats;
    std::vector<Oid> types;
};

/// A wrong URL is not repeated, by libpq neither: its words could hold the password.
void require_url(const std::string& url) {
    const bool ours = url.starts_with("postgresql://") || url.starts_with("postgres://");
    void* parsed = ours ? PQconninfoParse(url.c_str(), nullptr) : nullptr;
    const bool good = parsed != nullptr;
    PQconninfoFree(parsed);
    refuse_if(!good,
              "--to is no URL of a PostgreSQL server: give postgresql://USER@HOST/DATABASE, signs "
              "other than letters and digits as %XX");
}

}  // namespace

Postgres::Postgres(const std::string& url, bool insecure) {
    require_url(url);
    if (!insecure) {
        const std::unique_ptr<PGconn, void (*)(PGconn*)> begun(PQconnectStart(url.c_str()),
                                                               PQfinish);
        require_secure(begun.get());
    }
    connection_.reset(PQconnectdb(url.c_str()));
    if (PQstatus(of(connection_)) != kConnectionOk) {
        fail("connecting", PQerrorMessage(of(connection_)));
    }
    // What the server remarks would go to standard error as it comes; what fails is thrown.
    PQsetNoticeProcessor(
        of(connection_), [](void*, const char*) {}, nullptr);
    run("SET client_min_messages = warning; SET client_encoding = 'UTF8'");
}

std::string Postgres::way() const {
    PGconn* connection = of(connection_);
    const char* host = PQhost(connection);
    std::string text = host == nullptr || *host == '\0' ? "?" : host;
    if (PQsslInUse(connection) == 0) {
        return text + ", not encrypted by TLS";
    }
    const char* version = PQsslAttribute(connection, "protocol");
    return fmt::format("{}, over {}, the server {}", text, version == nullptr ? "TLS" : version,
                       word_of(connection, "sslmode") == "verify-full" ? "checked" : "not checked");
}

void Postgres::Finish::operator()(void* connection) const {
    PQfinish(static_cast<PGconn*>(connection));
}

void Postgres::fail(std::string_view doing, const char* words) const {
    std::string said = words;
    const char* password = PQpass(of(connection_));
    for (std::size_t at = 0; password != nullptr && *password != '\0' &&
                             (at = said.find(password)) != std::string::npos;) {
        said.replace(at, std::strlen(password), "...");
        if (std::strstr("...", password) != nullptr) {
            break;
        }
    }
    while (!said.empty() && said.back() == '\n') {
        said.pop_back();
    }
    for (std::size_t at = 0; (at = said.find_first_of("\n\t", at)) != std::string::npos;) {
        const std::size_t end = std::min(said.find_first_not_of("\n\t", at), said.size());
        said.replace(at, end - at, "; ");
    }
    const char* host = PQhost(of(connection_));
    throw PostgresError(fmt::format("PostgreSQL at {}: {} failed: {}",
                                    host == nullptr || *host == '\0' ? "?" : host, doing, said));
}

void Postgres::run(const std::string& sql) {
    const Result result(PQexec(of(connection_), sql.c_str()));
    if (!is_good(result)) {
        fail("a statement", PQerrorMessage(of(connection_)));
    }
}

std::vector<std::vector<std::optional<std::string>>> Postgres::rows(const std::string& sql,
                                                                    const PostgresRow& row) {
    const Parameters all(row);
    const Result result(PQexecParams(of(connection_), sql.c_str(),
                                     static_cast<int>(all.values.size()), all.types.data(),
                                     all.values.data(), all.lengths.data(), all.formats.data(), 0));
    if (!is_good(result)) {
        fail("a query", PQerrorMessage(of(connection_)));
    }
    std::vector<std::vector<std::optional<std::string>>> found;
    for (int line = 0; line < PQntuples(result.get()); ++line) {
        auto& values = found.emplace_back();
        for (int column = 0; column < PQnfields(result.get()); ++column) {
            const bool null = PQgetisnull(result.get(), line, column) != 0;
            values.push_back(
                null ? std::nullopt
                     : std::optional<std::string>(PQgetvalue(result.get(), line, column)));
        }
    }
    return found;
}

void Postgres::send(const std::string& sql, const PostgresRow& row) {
    const Parameters all(row);
    if ((waiting_ == 0 && PQenterPipelineMode(of(connection_)) == 0) ||
        PQsendQueryParams(of(connection_), sql.c_str(), static_cast<int>(all.values.size()),
                          all.types.data(), all.values.data(), all.lengths.data(),
                          all.formats.data(), 0) == 0) {
        fail("sending rows", PQerrorMessage(of(connection_)));
    }
    ++waiting_;
}

std::int64_t Postgres::flush() {
    if (waiting_ == 0) {
        return 0;
    }
    // Without BEGIN, all statements up to a sync are one transaction.
    if (PQpipelineSync(of(connection_)) == 0) {
        fail("sending rows", PQerrorMessage(of(connection_)));
    }
    std::int64_t added = 0;
    std::string wrong;
    bool ended = false;
    for (bool synced = false; !synced;) {
        PGresult* next = PQgetResult(of(connection_));
        if (next == nullptr) {
            // The end of a statement's results. Twice in a row nothing is left to wait for, and the
            // sync did not come: the server is gone, whatever PQstatus says.
            if (ended || PQstatus(of(connection_)) != kConnectionOk) {
                fail("sending rows",
                     wrong.empty() ? PQerrorMessage(of(connection_)) : wrong.c_str());
            }
            ended = true;
            continue;
        }
        ended = false;
        const Result result(next);
        const int status = PQresultStatus(next);
        synced = status == kPipelineSync;
        if (status == kCommandOk) {
            added += std::atoll(PQcmdTuples(next));
        } else if (!synced && status != kTuplesOk && status != kPipelineAborted && wrong.empty()) {
            wrong = PQresultErrorMessage(next);
        }
    }
    waiting_ = 0;
    PQexitPipelineMode(of(connection_));
    if (!wrong.empty()) {
        fail("adding rows", wrong.c_str());
    }
    return added;
}

}  // namespace palpate::data
