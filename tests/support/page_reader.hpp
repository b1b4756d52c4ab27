#pragma once

#include <nlohmann/json.hpp>

#include "tests/support/program.hpp"

/// Reads a page of palpate report as text.
namespace palpate::tests {

/// What palpate report makes of a database, with more words.
inline std::string page_of(const std::string& file, const Words& words) {
    const std::string page = file + ".html";
    ran(joined({"report", file, "-o", page}, words));
    return slurp(page);
}

/// Text that stood between tags.
inline std::string unescaped(std::string text) {
    for (const auto& [entity, c] : std::initializer_list<std::pair<const char*, const char*>>{
             {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}, {"&amp;", "&"}}) {
        text = all_replaced(std::move(text), entity, c);
    }
    return text;
}

/// The text of an address data:text/csv;charset=utf-8,...
inline std::string of_address(const std::string& address) {
    std::string text;
    for (std::size_t i = address.find(',') + 1; i < address.size(); ++i) {
        if (address[i] == '%') {
            text += static_cast<char>(std::stoi(address.substr(i + 1, 2), nullptr, 16));
            i += 2;
        } else {
            text += address[i];
        }
    }
    return text;
}

/// What stands beside a figure.
struct Source {
    std::string sql;
    std::string csv;
};

/// SQL and CSV that stand beside figures and tables, by the CSV's name.
inline std::map<std::string, Source> sources_of(const std::string& page) {
    std::map<std::string, Source> found;
    const std::string sql = "<pre tabindex=\"0\"><code>";
    for (std::size_t at = page.find(sql); at != std::string::npos; at = page.find(sql, at + 1)) {
        const std::size_t begin = at + sql.size();
        const std::size_t name = page.find("download=\"", begin) + 10;
        const std::size_t href = page.find("href=\"", name) + 6;
        found[page.substr(name, page.find('"', name) - name)] = {
            unescaped(page.substr(begin, page.find("</code>", begin) - begin)),
            of_address(page.substr(href, page.find('"', href) - href))};
    }
    return found;
}

/// What tick_text() of html.hpp promises, read by its words. NaN: none.
inline std::vector<double> ticks_of(const std::string& text, double step) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bits;
    for (const char c : text) {
        for (int k = 5; k >= 0 && c != '='; --k) {
            bits += (digits.find(c) >> static_cast<unsigned>(k)) % 2 == 1 ? '1' : '0';
        }
    }
    std::vector<int> bytes;
    for (std::size_t i = 0; i + 8 <= bits.size(); i += 8) {
        bytes.push_back(std::stoi(bits.substr(i, 8), nullptr, 2));
    }
    const int order = bytes.at(0);
    std::vector<double> out;
    double last = 0.0;
    double before = 0.0;
    std::size_t at = 1;
    const auto next = [&] {
        double value = 0.0;
        double factor = 1.0;
        do {
            value += factor * (bytes.at(at) % 128);
            factor *= 128.0;
        } while (bytes.at(at++) > 127);
        return value;
    };
    while (at < bytes.size()) {
        const double folded = next();
        const double again = folded == 0.0 ? next() : 0.0;
        const double rest = std::fmod(folded, 2.0) == 0.0 ? folded / 2.0 : -(folded + 1.0) / 2.0;
        for (double k = 0.0; k <= again; k += 1.0) {
            const double value = rest + (order == 0   ? 0.0
                                         : order == 1 ? last
                                                      : 2.0 * last - before);
            before = last;
            last = value;
            out.push_back(value == -2147483648.0 ? std::nan("") : step * value);
        }
    }
    return out;
}

/// What a browser without a window makes of a page: as its script left it, without an error and
/// without a request. None where there is no Chromium.
inline std::optional<std::string> browsed(const TemporaryFolder& folder, const std::string& page) {
    if (!installed("Chromium", {"sh", "-c", "command -v chromium"})) {
        return std::nullopt;
    }
    const Finished done = ended(
        Process({"chromium", "--headless=new", "--no-sandbox", "--disable-gpu",
                 "--disable-background-networking", "--disable-component-update", "--no-first-run",
                 "--allow-file-access-from-files", "--enable-logging=stderr",
                 "--window-size=1000,1400", "--user-data-dir=" + folder.file("profile"),
                 "--log-net-log=" + folder.file("net.json"), "--dump-dom", "file://" + page})
            .wait());
    CHECK_THAT(done.error, !Has("CONSOLE"));
    // The browser itself asks its maker for news; what a page asks for has an initiator of its own.
    const std::string net = slurp(folder.file("net.json"));
    CHECK(net.size() > 10000);
    CHECK(count_of(net, "\"initiator\":") == count_of(net, "\"initiator\":\"not an origin\""));
    return done.out;
}

/// Each number of a JSON, in the fewest digits that read back to the same bits.
inline void add_numbers(const nlohmann::ordered_json& json, std::set<std::string>& all) {
    if (json.is_number()) {
        all.insert(fmt::format("{}", json.get<double>()));
    }
    if (json.is_structured()) {
        for (const auto& one : json) {
            add_numbers(one, all);
        }
    }
}

/// The fields of a CSV that are numbers with an end, as add_numbers() writes them.
inline Words numbers_of(std::string csv) {
    Words numbers;
    std::ranges::replace(csv, '\n', ',');
    for (const std::string& field : split(csv)) {
        double value = 0.0;
        const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
        if (error == std::errc() && end == field.data() + field.size() && std::isfinite(value)) {
            numbers.push_back(fmt::format("{}", value));
        }
    }
    return numbers;
}

}  // namespace palpate::tests
