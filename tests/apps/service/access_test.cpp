// Access control of the service.
#include "apps/service/http/access.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <csignal>
#include <fstream>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "apps/service/http/query.hpp"
#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"
#include "support/temp_dir.hpp"

namespace trivet::apps::service {
namespace {

using test::Answer;
using test::ask;
using Headers = std::vector<std::pair<std::string, std::string>>;

HttpRequest head_of(const std::string& method, const std::string& target, Headers headers) {
  HttpRequest head;
  head.method = method;
  head.target = target;
  head.headers = std::move(headers);
  head.local_address = "10.0.0.7";
  return head;
}

/// The reason for refusing a request; empty: it is accepted.
std::string fault_of(const Access& access, const HttpRequest& head, bool is_free = false) {
  const auto refusal = access.refuse(head, is_free);
  return refusal ? std::string(name_of(refusal->fault)) : "";
}

/// The response to a raw request that includes a Host header.
Answer send(int port, const std::string& head) {
  const test::Connection connection(port);
  connection.send(head + "\r\nConnection: close\r\n\r\n");
  return test::parse_answer(connection.receive());
}

TEST(Access, ServesTheNamesOfLoopbackTheAddressOfTheConnectionAndThoseGiven) {
  const Access access({"cell.example", "192.0.2.1"}, nullptr);
  for (const char* const host :
       {"localhost", "LocalHost:8080", "localhost.", "127.0.0.1", "127.0.0.1:1", "127.8.8.8",
        "[::1]:8080", "[::1]", "[0:0:0:0:0:0:0:1]", "10.0.0.7:8080", "[::ffff:10.0.0.7]",
        "cell.example", "CELL.example.:443", "192.0.2.1:8080", ""}) {
    EXPECT_EQ(fault_of(access, head_of("GET", "/", {{"host", host}})), "") << host;
  }
  EXPECT_EQ(fault_of(access, head_of("GET", "/", {})), "") << "as probes that speak HTTP/1.0";
  for (const char* const host :
       {"evil.example", "10.0.0.8", "0.0.0.0", "localhost.evil.example", "127.0.0.1.evil.example",
        "evil.example:8080", "cell.example@evil.example", "2130706433", "0x7f.1", "[::2]", "[::1",
        "localhost:80:80", "localhost:x", "localhost/", "cell.exampleX", ".cell.example", "null"}) {
    const auto refusal = access.refuse(head_of("GET", "/v2/health/live", {{"host", host}}), true);
    ASSERT_TRUE(refusal) << host;
    EXPECT_EQ(refusal->status, 421U) << host;
    EXPECT_NE(refusal->reason.find("--host-name"), std::string::npos) << refusal->reason;
  }
  HttpRequest named = head_of("GET", "/", {{"host", "localhost"}});
  named.named_host = "evil.example";
  EXPECT_EQ(fault_of(access, named), "host") << "of http://evil.example/ as the target";
}

TEST(Access, ReadsHostNamesAsBrowsersSendThem) {
  for (const auto& [given, name] :
       std::vector<std::pair<const char*, const char*>>{{"Cell.Example", "cell.example"},
                                                        {"cell.example.", "cell.example"},
                                                        {"[2001:DB8:0::1]", "2001:db8::1"},
                                                        {"::ffff:10.0.0.1", "10.0.0.1"},
                                                        {"10.0.0.1", "10.0.0.1"}}) {
    const Result<std::string> read = parse_host_name(given);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(*read, name);
  }
  for (const char* const wrong : {"", ".", "http://cell", "cell:8080", "*", "a b", "a/b", "a@b"})
    EXPECT_FALSE(parse_host_name(wrong)) << wrong;
}

TEST(Access, LetsOnlyItsOwnPageChangeAndRecognize) {
  const Access access({"cell.example"}, nullptr);
  const auto fault = [&](const char* method, Headers headers) {
    return fault_of(access, head_of(method, "/v1/recognize", std::move(headers)));
  };
  const std::pair<std::string, std::string> page{"x-trivet", "page"};
  EXPECT_EQ(fault("POST", {{"host", "localhost:8080"}}), "") << "no browser";
  for (const char* const method : {"POST", "PUT", "PATCH", "DELETE", "post", "TRACE", "anything"}) {
    EXPECT_EQ(fault(method, {{"host", "localhost:8080"}, {"origin", "http://evil.example"}, page}),
              "origin");
    EXPECT_EQ(fault(method, {{"host", "localhost:8080"}, {"origin", "null"}, page}), "origin");
    EXPECT_EQ(
        fault(method, {{"host", "localhost:8080"}, {"origin", "http://localhost:9090"}, page}),
        "origin")
        << "another service of this machine";
    EXPECT_EQ(fault(method, {{"host", "localhost:8080"}, {"origin", "http://localhost:8080"}}),
              "page")
        << "what a form may send";
    EXPECT_EQ(fault(method, {{"host", "localhost:8080"}, {"sec-fetch-site", "cross-site"}, page}),
              "origin");
    EXPECT_EQ(fault(method, {{"host", "localhost:8080"}, {"sec-fetch-site", "same-origin"}}),
              "page");
    EXPECT_EQ(
        fault(method, {{"host", "localhost:8080"}, {"origin", "http://localhost:8080"}, page}), "");
  }
  EXPECT_EQ(fault("POST", {{"host", "Cell.example"}, {"origin", "https://cell.example"}, page}), "")
      << "behind a proxy with TLS";
  EXPECT_EQ(fault("POST", {{"host", "cell.example:443"}, {"origin", "https://cell.example"}, page}),
            "");
  EXPECT_EQ(fault("POST", {{"host", "cell.example:443"}, {"origin", "http://cell.example"}, page}),
            "origin");
  EXPECT_EQ(fault("POST", {{"origin", "http://localhost"}, page}), "origin") << "of no host";
  // A page of another origin cannot read the response, since no response allows it to.
  EXPECT_EQ(fault("GET", {{"host", "localhost"}, {"origin", "http://evil.example"}}), "");
}

TEST(Access, AsksForATokenWhereThereAreSome) {
  BearerTokens tokens;
  tokens.set({"first-token", "a.b_c~d+e/f=="});
  const Access access({}, &tokens);
  const auto fault = [&](const std::string& authorization, bool is_free = false) {
    return fault_of(access, head_of("GET", "/v1/models", {{"authorization", authorization}}),
                    is_free);
  };
  for (const char* const good :
       {"Bearer first-token", "bearer first-token", "BEARER  a.b_c~d+e/f== "})
    EXPECT_EQ(fault(good), "") << good;
  for (const char* const wrong :
       {"", "Bearer", "Bearer ", "first-token", "Basic first-token", "Bearer first-toke",
        "Bearer first-token1", "Bearer first-tokem", "Bearer first-tokenfirst-token",
        "Bearer first-token,first-token", "Bearer First-token"}) {
    EXPECT_EQ(fault(wrong), "token") << wrong;
    EXPECT_EQ(fault(wrong, true), "") << "what needs none";
  }
  const HttpResponse refused = access.refuse(head_of("GET", "/v1/models", {}), false)->response();
  EXPECT_EQ(refused.status, 401U);
  EXPECT_EQ(refused.headers.front().first, "WWW-Authenticate");
  EXPECT_TRUE(refused.headers.front().second.starts_with("Bearer"));
  tokens.set({"second"});
  EXPECT_EQ(fault("Bearer first-token"), "token");
  EXPECT_EQ(fault("Bearer second"), "");
}

TEST(TokenFile, IsReadLineByLineAndNeverRepeated) {
  const test::TempDir folder;
  folder.write("good", "# of the cell\n\n  abc.def \r\nsecond");
  const Result<TokenFile> good = read_token_file(folder / "good");
  ASSERT_TRUE(good) << good.error().message;
  EXPECT_EQ(good->tokens, (std::vector<std::string>{"abc.def", "second"}));
  ::chmod((folder / "good").c_str(), 0640);
  EXPECT_FALSE(read_token_file(folder / "good")->is_readable_by_others);
  ::chmod((folder / "good").c_str(), 0644);
  EXPECT_TRUE(read_token_file(folder / "good")->is_readable_by_others);
  for (const auto& [text, words] : std::vector<std::pair<const char*, const char*>>{
           {"", "found none"}, {"# nothing\n\n", "found none"}, {"good\nse cret\n", ":2: "}}) {
    folder.write("bad", text);
    const Result<TokenFile> bad = read_token_file(folder / "bad");
    ASSERT_FALSE(bad) << text;
    EXPECT_NE(bad.error().message.find(words), std::string::npos) << bad.error().message;
    EXPECT_EQ(bad.error().message.find("cret"), std::string::npos) << bad.error().message;
  }
  EXPECT_FALSE(read_token_file(folder / "none"));
}

TEST(CheckPath, AcceptsUnambiguousTokens) {
  for (const char* const good :
       {"/", "/v1/models", "/v1/models/", "/v1/models/a%20b/mesh.ply", "/v1/models/%C3%A4",
        "/v1/models/bolt(1),2;a=@:!$&'*+", "/a/...", "/a.b/..c", "/v1/models/50%25",
        "/v1/models/50%25x", "/v1/models/a?b=../%2e%2f//%64"}) {
    const Result<void> checked = check_path(good);
    EXPECT_TRUE(checked) << good << ": " << checked.error().message;
  }
  for (const char* const wrong : {"",
                                  "*",
                                  "v1",
                                  "http://a/b",
                                  "//",
                                  "//v1/library/reload",
                                  "/v1//library/reload",
                                  "/v1/.",
                                  "/v1/../v1",
                                  "/./v1",
                                  "/..",
                                  "/%2e%2e/v1",
                                  "/%2E./v1",
                                  "/v1/library/reloa%64",
                                  "/v1/library/%72eload",
                                  "/v1%2flibrary",
                                  "/v1%2Flibrary",
                                  "/v1%5clibrary",
                                  "/v1\\library",
                                  "/%00",
                                  "/a%0d%0ab",
                                  "/%7f",
                                  "/%252e%252e/",
                                  "/a%2564",
                                  "/a%2",
                                  "/a%zz",
                                  "/a b",
                                  "/\xc3\xa4",
                                  "/a#b",
                                  "/a|b",
                                  "/%7Ea",
                                  "/%2D"}) {
    EXPECT_FALSE(check_path(wrong)) << wrong;
  }
}

class AccessToAService : public test::ServeFixture {
 protected:
  static int refused(int port, const std::string& reason, const std::string& headers = "") {
    const std::string metrics = ask(port, "GET", "/metrics", "", headers).body;
    std::smatch found;
    const std::regex line("\ntrivet_refused_total\\{reason=\"" + reason + "\"\\} ([0-9]+)");
    return std::regex_search(metrics, found, line) ? std::stoi(found[1]) : -1;
  }
};

TEST_F(AccessToAService, IsForItsHostsAndItsOwnPage) {
  const std::string scan = test::read_bytes(depth_);
  const auto outcome =
      serve({"--host-name", "cell.example", "--host-name", "other"}, [&](int port) {
        const std::string live = "GET /v2/health/live HTTP/1.1\r\nHost: ";
        const auto status = [&](const std::string& host) { return send(port, live + host).status; };
        EXPECT_EQ(status("cell.example:8080"), 200);
        EXPECT_EQ(status("other"), 200);
        EXPECT_EQ(status(fmt::format("127.0.0.1:{}", port)), 200);
        EXPECT_EQ(send(port, "GET /v2/health/live HTTP/1.0").status, 200);
        const Answer misled = send(port, live + "evil.example");
        EXPECT_EQ(misled.status, 421);
        EXPECT_NE(misled.body.find("--host-name"), std::string::npos) << misled.body;
        EXPECT_EQ(
            send(port, "GET http://evil.example/v2/health/live HTTP/1.1\r\nHost: other").status,
            421);
        EXPECT_EQ(send(port, "GET / HTTP/1.0\r\nHost: other\r\nHost: evil.example").status, 400);

        const std::string elsewhere = "Origin: http://evil.example\r\n",
                          own = "Origin: http://localhost\r\n", page = own + "X-Trivet: page\r\n";
        EXPECT_EQ(ask(port, "POST", query_, scan, elsewhere).status, 403);
        EXPECT_EQ(ask(port, "POST", query_, scan, own + "Content-Type: text/plain\r\n").status,
                  403);
        EXPECT_EQ(ask(port, "POST", query_, scan, page).status, 200);
        EXPECT_EQ(ask(port, "POST", query_, scan).status, 200);
        const Answer preflight = ask(port, "OPTIONS", "/v1/recognize", "",
                                     elsewhere + "Access-Control-Request-Headers: x-trivet\r\n");
        EXPECT_EQ(preflight.status, 405);
        EXPECT_EQ(preflight.head.find("Access-Control"), std::string::npos) << preflight.head;
        EXPECT_EQ(ask(port, "POST", "/v1/library/reloa%64").status, 400);
        EXPECT_EQ(ask(port, "post", "/v1/library/reload").status, 405);
        EXPECT_EQ(refused(port, "host"), 2);
        EXPECT_EQ(refused(port, "origin"), 1);
        EXPECT_EQ(refused(port, "page"), 1);
        EXPECT_EQ(refused(port, "path"), 1);
        EXPECT_EQ(refused(port, "token"), 0);
      });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.error.find("\"refusal\":\"host\",\"code\":421"), std::string::npos)
      << outcome.error;
}

TEST_F(AccessToAService, IsForThoseWithAToken) {
  folder_.write("tokens", "# of the cell\nfirst-token\n");
  const auto outcome = serve({"--token-file", "tokens"}, [&](int port) {
    const auto status = [&](const std::string& target, const std::string& token) {
      return ask(port, "GET", target, "", "Authorization: Bearer " + token + "\r\n").status;
    };
    for (const char* const target : {"/v2/health/live", "/v2/health/ready", "/"})
      EXPECT_NE(ask(port, "GET", target).status, 401) << target;
    for (const char* const target :
         {"/v1/models", "/v1/openapi.json", "/v2", "/metrics", "/nothing"}) {
      const Answer refused = ask(port, "GET", target);
      EXPECT_EQ(refused.status, 401) << target;
      EXPECT_NE(refused.head.find("\r\nWWW-Authenticate: Bearer"), std::string::npos);
    }
    EXPECT_EQ(ask(port, "POST", query_, test::read_bytes(depth_)).status, 401);
    EXPECT_EQ(status("/v1/models", "first-token"), 200);
    EXPECT_EQ(status("/v1/models", "wrong-token"), 401);
    folder_.write("tokens", "second-token\n");
    ::kill(process_, SIGHUP);
    EXPECT_TRUE(test::comes([&] { return status("/v1/models", "second-token") == 200; }));
    EXPECT_EQ(status("/v1/models", "first-token"), 401);
    // An unreadable token file changes nothing.
    folder_.write("tokens", "");
    ::kill(process_, SIGHUP);
    EXPECT_TRUE(test::comes([&] {
      const std::string metrics =
          ask(port, "GET", "/metrics", "", "Authorization: Bearer second-token\r\n").body;
      return metrics.find("trivet_reload_total{result=\"good\"} 2") != std::string::npos;
    }));
    EXPECT_EQ(status("/v1/models", "second-token"), 200);
    EXPECT_GE(refused(port, "token", "Authorization: Bearer second-token\r\n"), 8);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  for (const char* const token : {"first-token", "second-token", "wrong-token"})
    EXPECT_EQ(outcome.error.find(token), std::string::npos) << "a token in the log";
  EXPECT_NE(outcome.error.find("tokens not reloaded"), std::string::npos) << outcome.error;
  folder_.write("tokens", "\n");
  const auto refused = serve({"--token-file", "tokens", "--check-config"}, [](int) {});
  EXPECT_EQ(refused.exit_code, 2) << refused.error;
}

TEST_F(AccessToAService, ChangesNothingIfItOnlyReads) {
  const std::string scan = test::read_bytes(depth_);
  serve({"--session", "cell"}, [&](int port) {
    EXPECT_EQ(
        ask(port, "PUT", "/v1/session/scans/a?format=png&" + parameters_.substr(11), scan).status,
        200);
  });
  const auto outcome = serve({"--read-only", "--session", "cell"}, [&](int port) {
    for (const auto& [method, target] :
         std::vector<std::pair<std::string, std::string>>{{"POST", "/v1/library/reload"},
                                                          {"PUT", "/v1/parts/a?file=a.ply&unit=m"},
                                                          {"PATCH", "/v1/parts/a"},
                                                          {"DELETE", "/v1/parts/a"},
                                                          {"PUT", "/v1/models/a"},
                                                          {"PATCH", "/v1/models/a?name=b"},
                                                          {"DELETE", "/v1/models/a"},
                                                          {"PUT", "/v1/session/scans/b?format=png"},
                                                          {"PUT", "/v1/session/scans/a/truth"},
                                                          {"DELETE", "/v1/session/scans/a"},
                                                          {"PUT", "/v1/session/runs/A/a"},
                                                          {"DELETE", "/v1/session/runs/A"}}) {
      const Answer refused = ask(port, method, target);
      EXPECT_EQ(refused.status, 403) << method << " " << target;
      EXPECT_NE(refused.body.find("--read-only"), std::string::npos) << refused.body;
    }
    EXPECT_EQ(refused(port, "read_only"), 12);
    EXPECT_EQ(ask(port, "POST", query_, scan).status, 200);
    EXPECT_EQ(ask(port, "GET", "/v1/session/scans/a").body, scan);
    EXPECT_EQ(ask(port, "POST", "/v2/repository/index").status, 200);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
  folder_.write("serve.toml", "read-only = true\nallow-training = \"drafts\"\n");
  const auto refused = serve({"--config", "serve.toml"}, [](int) {});
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.error.find("read-only: expected no allow-training"), std::string::npos)
      << refused.error;
}

}  // namespace
}  // namespace trivet::apps::service
