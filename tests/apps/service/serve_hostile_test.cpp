/// Malformed requests: each is refused with a reason, and the next valid request is answered.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "apps/service/gzip.hpp"
#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"
#include "support/degenerate_geometry.hpp"
#include "support/geometry_files.hpp"

namespace trivet {
namespace {

using test::Answer;
using test::ask;
using test::Connection;
using test::parse_answer;
using test::read_bytes;

class ServeHostile : public test::ServeFixture {
 protected:
  /// Expects a refusal with one of these statuses, with a reason in JSON.
  static void expect_refused(const std::string& what, const Answer& answer,
                             const std::set<int>& statuses, const std::string& reason = "") {
    EXPECT_TRUE(statuses.contains(answer.status)) << what << ": " << answer.head << answer.body;
    const nlohmann::json json = answer.json();
    ASSERT_TRUE(json.is_object() && json.contains("error")) << what << ": " << answer.body;
    EXPECT_NE(json["error"].dump().find(reason), std::string::npos) << what << ": " << answer.body;
    EXPECT_GT(json["error"].get<std::string>().size(), 10U) << what;
  }

  /// Expects a response to a valid request, as the next client would send it.
  void expect_answers(int port) const {
    EXPECT_EQ(ask(port, "POST", query_, read_bytes(depth_)).status, 200);
  }

  /// The peak memory of the service [kB].
  std::size_t peak_memory() const {
    const std::string status = read_bytes("/proc/" + std::to_string(process_) + "/status");
    const std::size_t at = status.find("VmHWM:");
    return at == status.npos ? 0 : std::stoul(status.substr(at + 6));
  }
};

/// The first response of the service to these bytes, before it closes the connection.
Answer say(int port, const std::string& bytes) {
  const Connection connection(port);
  connection.send(bytes);
  return parse_answer(connection.receive());
}

/// The same for a client that sends nothing more.
Answer say_at_most(int port, const std::string& bytes) {
  const Connection connection(port);
  connection.send(bytes);
  connection.finish();
  return parse_answer(connection.receive());
}

std::string post(const std::string& headers, const std::string& body) {
  return "POST /v1/recognize?format=ply HTTP/1.1\r\nHost: localhost\r\n" + headers + "\r\n" + body;
}

TEST_F(ServeHostile, RefusesFramesThatLie) {
  const std::string chunk = "3\r\nply\r\n0\r\n\r\n";
  struct Case {
    std::string what, bytes, reason;
    std::set<int> statuses{400};
  };
  const std::vector<Case> cases{
      {"a negative length", post("Content-Length: -1\r\n", "ply"), ""},
      {"a signed length", post("Content-Length: +3\r\n", "ply"), ""},
      {"two lengths", post("Content-Length: 3\r\nContent-Length: 4\r\n", "ply4"), ""},
      {"a list of lengths", post("Content-Length: 3, 4\r\n", "ply4"), ""},
      {"a length beyond 2^64", post("Content-Length: " + std::string(30, '9') + "\r\n", "ply"), ""},
      {"a length beyond the limit", post("Content-Length: 1048577\r\n", "ply"), "1048576", {413}},
      {"a length less than the body", post("Content-Length: 2\r\n", "ply\r\n\r\n"), "body.ply"},
      {"length and chunks", post("Content-Length: 3\r\nTransfer-Encoding: chunked\r\n", chunk), ""},
      {"chunks and length", post("Transfer-Encoding: chunked\r\nContent-Length: 3\r\n", chunk), ""},
      {"compressed chunks", post("Transfer-Encoding: gzip, chunked\r\n", chunk),
       "Transfer-Encoding"},
      {"chunks that do not end", post("Transfer-Encoding: chunked, identity\r\n", chunk),
       "Transfer-Encoding"},
      {"no known coding", post("Transfer-Encoding: xchunked\r\n", chunk), "Transfer-Encoding"},
      {"two codings", post("Transfer-Encoding: chunked\r\nTransfer-Encoding: identity\r\n", chunk),
       "Transfer-Encoding"},
      {"chunks of HTTP/1.0",
       "POST /v1/recognize?format=ply HTTP/1.0\r\nTransfer-Encoding: chunked\r\n\r\n" + chunk,
       "Transfer-Encoding"},
      {"a chunk without a size", post("Transfer-Encoding: chunked\r\n", "zz\r\nply\r\n"), ""},
      {"a chunk beyond 2^64",
       post("Transfer-Encoding: chunked\r\n", std::string(17, 'f') + "\r\nply\r\n"),
       "",
       {400, 413}},
      {"chunks beyond the limit",
       post("Transfer-Encoding: chunked\r\n", "200000\r\n" + std::string(2 << 20, 'x')),
       "1048576",
       {413}},
      {"asks before it sends too much",
       post("Expect: 100-continue\r\nContent-Length: 1000000000\r\n", ""),
       "1048576",
       {413}},
      {"no gzip", post("Content-Encoding: gzip\r\nContent-Length: 3\r\n", "ply"), "gzip body"},
      {"no deflate", post("Content-Encoding: deflate\r\nContent-Length: 3\r\n", "ply"),
       "deflate body"},
      {"a packed body in broken chunks",
       post("Content-Encoding: gzip\r\nTransfer-Encoding: chunked\r\n", "zz\r\nply\r\n"), ""},
      {"a packing that nobody knows",
       post("Content-Encoding: compress\r\nContent-Length: 3\r\n", "ply"),
       "gzip, deflate",
       {415}},
      {"two packings",
       post("Content-Encoding: gzip\r\nContent-Encoding: gzip\r\nContent-Length: 3\r\n", "ply"),
       "gzip, deflate",
       {415}},
      {"gzip behind identity",
       post("Content-Encoding: identity, gzip\r\nContent-Length: 3\r\n", "ply"),
       "Encoding",
       {415}},
      {"HTTP/0.9", "GET /v1/models\r\n\r\n", ""},
      {"HTTP/2", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", ""},
      {"HTTP/9.9", "GET /v1/models HTTP/9.9\r\nHost: localhost\r\n\r\n", ""},
      {"TLS", std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11) + "\r\n\r\n", ""},
      {"no host", "GET /v1/models HTTP/1.1\r\n\r\n", "Host"},
      {"two hosts", "GET /v1/models HTTP/1.1\r\nHost: localhost\r\nHost: b\r\n\r\n", "Host"},
      {"a blank before the colon", post("Content-Length : 3\r\n", "ply"), ""},
      {"a zero byte in the target",
       std::string("GET /v1/\0models HTTP/1.1\r\nHost: localhost\r\n\r\n", 46), ""},
      {"a zero byte in a header", post(std::string("X-A: \0\r\n", 8), ""), ""},
      {"a lone CR in a header", post("X-A: a\rX-B: b\r\n", ""), ""},
      {"a long target",
       "GET /" + std::string(20'000, 'a') + " HTTP/1.1\r\nHost: localhost\r\n\r\n",
       "8192",
       {431}},
      {"an unknown method",
       "BREW /v1/models HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n",
       "GET",
       {405}},
  };
  const test::Outcome outcome = serve({"--max-body-mb", "1"}, [&](int port) {
    for (const Case& one : cases)
      expect_refused(one.what, say(port, one.bytes), one.statuses, one.reason);
    // Half a request: no client waits for a response.
    EXPECT_EQ(say_at_most(port, post("Content-Length: 4\r\n", "ply")).status, 0);
    EXPECT_EQ(say_at_most(port, "GET /v1/mod").status, 0);
    expect_answers(port);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(ServeHostile, EndsRequestsThatNeverEnd) {
  const test::Outcome outcome = serve({"--request-timeout-ms", "1000"}, [&](int port) {
    const Connection waits(port), drips(port);
    waits.send(post("Content-Length: 4\r\n", "ply"));
    std::thread dripping([&] {
      drips.send(post("Transfer-Encoding: chunked\r\n", ""));
      for (int i = 0; i < 40; ++i) {
        drips.send("1\r\nx\r\n");
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      }
    });
    expect_refused("a length more than the body", parse_answer(waits.receive()), {408});
    dripping.join();
    expect_refused("chunks without end", parse_answer(drips.receive()), {408});
    expect_answers(port);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(ServeHostile, AnswersRequestsInARowInTheirOrder) {
  const test::Outcome outcome = serve({}, [&](int port) {
    const Connection connection(port);
    connection.send(
        "HEAD /v1/models HTTP/1.1\r\nHost: localhost\r\n\r\n"
        "GET /nowhere HTTP/1.1\r\nHost: localhost\r\n\r\n" +
        post("Content-Length: 3\r\n", "ply") +
        "GET /v2 HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    std::string rest = connection.receive();
    std::vector<std::string> statuses;
    for (std::size_t at = 0; (at = rest.find("HTTP/1.1 ", at)) != rest.npos; at += 9)
      statuses.push_back(rest.substr(at + 9, 3));
    EXPECT_EQ(statuses, (std::vector<std::string>{"200", "404", "400", "200"})) << rest;
    // A client would parse a body after the response to HEAD as the next response.
    EXPECT_EQ(parse_answer(rest).body.substr(0, 8), "HTTP/1.1");
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(ServeHostile, RefusesParametersThatAreNone) {
  const test::Outcome outcome = serve({}, [&](int port) {
    for (const char* const parameter : {"models=../../etc/passwd",
                                        "models=%ff%fe",
                                        "models=%00",
                                        "models=%0d%0aX-Evil:1",
                                        "min-score=nan",
                                        "min-score=inf",
                                        "min-score=-0.1",
                                        "min-score=0.5&min-score=0.6",
                                        "max-distance=nan",
                                        "max-ratio=0",
                                        "max-lean=nan",
                                        "keypoint-spacing=1e999",
                                        "normal-window=nan",
                                        "rounds=-1",
                                        "rounds=4294967296",
                                        "rounds=1e9",
                                        "max-votes=0",
                                        "max-instances=99999999999999999999",
                                        "unit=furlong",
                                        "viewpoint=nan,0,0",
                                        "viewpoint=0,0",
                                        "viewpoint=1e39,0,0",
                                        "region=0,0,0,nan,1,1",
                                        "region=1,1,1,0,0,0",
                                        "tilt=0,0,0,0,0,1,10",
                                        "tilt=nan,0,1,0,0,1,10",
                                        "tilt=inf,0,1,0,0,1,10",
                                        "tilt=0,0,1,0,0,1,nan",
                                        "format=ply&format=../etc",
                                        "expected=/etc/passwd",
                                        "config=/etc/passwd",
                                        "help",
                                        "h",
                                        "-",
                                        "=",
                                        "=x",
                                        "%00=1",
                                        "%",
                                        "%4",
                                        "min-score%3D0.5",
                                        "a=b=c"}) {
      const Answer answer = ask(port, "POST", query_ + "&" + parameter, read_bytes(depth_));
      expect_refused(parameter, answer, {400});
      EXPECT_EQ(answer.head.find("X-Evil"), std::string::npos);
    }
    for (const char* const camera : {"nan,1,1,1", "1,1,inf,1", "0,1,1,1", "-1,1,1,1", "1,1,1",
                                     "1,1,1,1,0", "1,1,1,1,nan", "1,1,1,1,1,1", "1e-320,1,1,1"}) {
      expect_refused(camera,
                     ask(port, "POST", std::string("/v1/recognize?format=png&camera=") + camera,
                         read_bytes(depth_)),
                     {400});
    }
    for (const char* const path :
         {"/v2/models/..%2f..", "/v2/models/../l", "/v2/models/", "/v2/models/l/versions/",
          "/v2/models/l/versions/99999999999999999999",
          "/v1/models/..%2f..%2fetc%2fpasswd/mesh.ply", "/v1/%00", "//v1/models", "*"}) {
      expect_refused(path, ask(port, "GET", path), {400, 404});
    }
    expect_answers(port);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(ServeHostile, RefusesTensorsThatAreNone) {
  const auto points = [](const std::string& shape, const std::string& rest) {
    return R"({"inputs":[{"name":"points","datatype":"FP32","shape":)" + shape + "," + rest + "}]}";
  };
  const test::Outcome outcome = serve({}, [&](int port) {
    for (const std::string& body : {
             std::string("{\"id\":\"\xff\xfe\",\"inputs\":[]}"),
             std::string("{\"inputs\":[\xc3\x28]}"),
             std::string("\0", 1),
             std::string("null"),
             std::string("[]"),
             std::string("{}"),
             std::string(100'000, '['),
             std::string(100'000, '{'),
             std::string(R"({"id":7,"inputs":[]})"),
             std::string(R"({"inputs":{}})"),
             std::string(R"({"inputs":[]})"),
             std::string(R"({"inputs":[],"parameters":[]})"),
             std::string(R"({"inputs":[],"parameters":{"min-score":"nan"}})"),
             std::string(R"({"inputs":[],"parameters":{"min-score":[1]}})"),
             std::string(R"({"inputs":[],"parameters":{"format":"\u0000"}})"),
             std::string(R"({"inputs":[{"name":"../../etc/passwd"}]})"),
             points("[1,3]", R"("data":[1e999,0,0])"),
             points("[1,3]", R"("data":[NaN,0,0])"),
             points("[1,3]", R"("data":["1","2","3"])"),
             points("[1,3]", R"("data":[[[1,2,3]]])"),
             points("[1,3]", R"("data":null)"),
             points("[-1,3]", R"("data":[])"),
             points("[0.5,3]", R"("data":[])"),
             points("[1e300,3]", R"("data":[])"),
             points("[100000000,3]", R"("data":[])"),
             points("[18446744073709551617,3]", R"("data":[])"),
             points("[1,4]", R"("data":[1,2,3,4])"),
             points("[3]", R"("data":[1,2,3])"),
             points("[1,3]", R"("parameters":{"binary_data_size":-1})"),
             points("[1,3]", R"("parameters":{"binary_data_size":1e18})"),
             points("[100000000,3]", R"("parameters":{"binary_data_size":1200000000})"),
         }) {
      expect_refused(body.substr(0, 200), ask(port, "POST", "/v2/models/l/infer", body), {400});
    }
    for (const char* const size : {"-1", "1e3", "99999999999999999999", "4294967296", "0x10"}) {
      expect_refused(size,
                     ask(port, "POST", "/v2/models/l/infer", R"({"inputs":[]})",
                         std::string("Inference-Header-Content-Length: ") + size + "\r\n"),
                     {400});
    }
    expect_answers(port);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(ServeHostile, AllocatesNoMemoryForWhatABodyOnlyPromises) {
  const std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex ";
  const std::string xyz = "\nproperty float x\nproperty float y\nproperty float z\n";
  // Enough bytes for this many pixels at the best possible compression.
  const std::string bomb = test::png_file(8000, 8000, 16, 0, "") + std::string(130'000, '\0');
  std::string gzip_bomb;
  for (int member = 0; member < 600; ++member)
    gzip_bomb += test::gzip_file(std::string(1 << 20, ' '));
  const test::Outcome outcome = serve({"--parallel", "1"}, [&](int port) {
    expect_answers(port);
    const std::size_t before = peak_memory();
    const std::vector<std::pair<std::string, std::string>> bodies{
        {"ply", ply + "1000000000" + xyz + "end_header\n" + std::string(100, '\0')},
        {"ply", ply + "18446744073709551615" + xyz + "end_header\n"},
        {"ply", ply + "1" + xyz +
                    "element face 1\nproperty list uint int vertex_indices\nend_header\n" +
                    std::string(12, '\0') + "\xff\xff\xff\xff"},
        {"pcd",
         "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 100000000\nHEIGHT "
         "1\nPOINTS 100000000\nDATA binary_compressed\n" +
             test::little(std::uint32_t{4}) + test::little(std::uint32_t{1'200'000'000}) + "abcd"},
        {"off", "OFF 1000000000 1000000000 0\n0 0 0\n"},
        {"stl", std::string(80, ' ') + "\xff\xff\xff\x7f" + std::string(50, '\0')},
        {"png", test::png_file(50'000, 50'000, 16, 0, std::string(100, '\0'))},
        {"png", test::png_file(0xFFFFFFFF, 0xFFFFFFFF, 16, 0, "")},
        {"png", bomb},
        {"xyz", gzip_bomb},
    };
    for (const auto& [format, body] : bodies) {
      expect_refused(format + ": " + body.substr(0, 60),
                     ask(port, "POST", "/v1/recognize?camera=500,500,0,0&format=" + format, body),
                     {400, 413}, "body." + format);
    }
    // Rows of empty arrays need the most memory for their size of all JSON.
    std::string rows = R"({"inputs":[{"name":"points","datatype":"FP32","shape":[1,3],"data":[[])";
    while (rows.size() < 15'000'000) rows += ",[]";
    expect_refused("rows of none", ask(port, "POST", "/v2/models/l/infer", rows + "]}]}"), {400},
                   "3 numbers");
    expect_refused("more JSON than is read",
                   ask(port, "POST", "/v2/models/l/infer", rows + rows + "]}]}"), {400}, "binary");
#ifndef __SANITIZE_ADDRESS__
    EXPECT_LT(peak_memory() - before, 500'000U) << "kB";
#endif
    expect_answers(port);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(ServeHostile, UnpacksNoBombs) {
  const std::string scan = read_bytes(depth_);
  const std::string packed = test::pack(test::Packing::gzip, scan);
  const std::string bomb = test::pack(test::Packing::gzip, std::string(64 << 20, '\0'));
  const test::Outcome outcome = serve({"--parallel", "1", "--max-body-mb", "8"}, [&](int port) {
    const Answer plain = ask(port, "POST", query_, scan);
    const Answer unpacked = ask(port, "POST", query_, packed, "Content-Encoding: gzip\r\n");
    EXPECT_EQ(unpacked.status, 200) << unpacked.body;
    EXPECT_EQ(unpacked.json()["scenes"][0]["detections"], plain.json()["scenes"][0]["detections"]);
    [[maybe_unused]] const std::size_t before = peak_memory();
    std::vector<std::thread> clients;
    for (int i = 0; i < 20; ++i) {
      clients.emplace_back([&, i] {
        const std::string headers = "Content-Encoding: gzip\r\n";
        expect_refused("a bomb",
                       ask(port, i % 2 ? "POST" : "GET", i % 2 ? query_ : "/v2", bomb, headers),
                       {413}, "8388608");
      });
    }
    EXPECT_EQ(ask(port, "GET", "/v2/health/live").status, 200);
    for (std::thread& client : clients) client.join();
#ifndef __SANITIZE_ADDRESS__
    EXPECT_LT(peak_memory() - before, 50'000U) << "kB";
#endif
    expect_answers(port);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

// These 16 bytes once ended the service: "v 1 2 3\nf 1 1 1\n".
TEST_F(ServeHostile, AnswersMeshesThatAreHardlyASurface) {
  const test::Outcome outcome = serve({}, [&](int port) {
    const std::string target = "/v1/recognize?format=obj&unit=mm";
    const auto expect_answered = [&](const std::string& what, const Cloud& mesh) {
      const Answer answer = ask(port, "POST", target, test::obj_file(mesh));
      if (answer.status != 200) expect_refused(what, answer, {400});
    };
    expect_refused("16 bytes", ask(port, "POST", target, "v 1 2 3\nf 1 1 1\n"), {400}, "body.obj");
    for (const test::DegenerateMesh& mesh : test::degenerate_meshes()) {
      const std::size_t n = mesh.cloud.points.size();
      if (n == 1 || n == 3 || n == 12) expect_answered(mesh.name, mesh.cloud);
    }
    expect_answered("layers", test::layered_tetrahedron(100));
    expect_answered("shifted layers", test::shifted_tetrahedra(100));
#ifndef __SANITIZE_ADDRESS__
    EXPECT_LT(peak_memory(), 1'000'000U) << "kB";
#endif
    expect_answers(port);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(ServeHostile, RepeatsOnlyWellFormedWordsInItsHeaders) {
  const std::string trace = "00-4bf92f3577b34da6a3ce929d0e0e4736-00f067aa0ba902b7-01";
  const test::Outcome outcome = serve({}, [&](int port) {
    const auto head = [&](const std::string& headers) {
      return ask(port, "GET", "/v2", "", headers).head;
    };
    EXPECT_NE(head("traceparent: " + trace + "\r\n").find("traceparent: " + trace),
              std::string::npos);
    EXPECT_NE(head("X-Request-Id: a-1_b.C\r\n").find("X-Request-Id: a-1_b.C"), std::string::npos);
    const std::string zeros(32, '0');
    for (const std::string& wrong : std::vector<std::string>{
             "00-ab-cd-01", trace.substr(1), trace + "-00", "ff" + trace.substr(2),
             "00-4BF92F3577B34DA6A3CE929D0E0E4736-00f067aa0ba902b7-01",
             "00-" + zeros + "-00f067aa0ba902b7-01", trace.substr(0, 36) + "0000000000000000-01",
             "<script>", std::string(300, 'a')}) {
      EXPECT_EQ(head("traceparent: " + wrong + "\r\n").find("traceparent"), std::string::npos)
          << wrong;
      if (wrong.size() == 300 || wrong[0] == '<') {
        EXPECT_EQ(head("X-Request-Id: " + wrong + "\r\n").find(wrong), std::string::npos) << wrong;
      }
    }
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

}  // namespace
}  // namespace trivet
