// Another process writes the library under a running service: the service reports it, never answers
// from it, and keeps running.
#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "apps/service/http_client.hpp"
#include "apps/service/serve_fixture.hpp"
#include "storage/library/library.hpp"

namespace trivet::test {
namespace {

namespace fs = std::filesystem;

class ChangedLibrary : public ServeFixture {
 protected:
  void SetUp() override {
    ServeFixture::SetUp();
    library_ = folder_ / "l.h5";
    bytes_ = read_bytes(library_);
    scan_ = read_bytes(depth_);
  }
  /// Overwrites the existing file in place, as `cp` does.
  void overwrite(std::string_view bytes) const {
    std::ofstream(library_, std::ios::binary | std::ios::trunc) << bytes;
  }
  static nlohmann::json detections(const Answer& answer) {
    return answer.json()["scenes"][0]["detections"];
  }

  fs::path library_;
  std::string bytes_, scan_;
};

TEST_F(ChangedLibrary, IsRefusedByNameUntilItIsReloaded) {
  const Outcome outcome = serve({}, [&](int port) {
    const Answer before = ask(port, "POST", query_, scan_);
    ASSERT_EQ(before.status, 200);
    const auto expect_refused = [&] {
      for (const std::string& target : {query_, std::string("/v1/models/missing/mesh.ply")}) {
        const Answer refused =
            ask(port, target == query_ ? "POST" : "GET", target, target == query_ ? scan_ : "");
        EXPECT_EQ(refused.status, 503) << refused.body;
        EXPECT_NE(refused.body.find("l.h5"), std::string::npos) << refused.body;
        EXPECT_NE(refused.body.find("reload"), std::string::npos) << refused.body;
      }
      EXPECT_EQ(ask(port, "GET", "/v2/health/ready").status, 503);
      EXPECT_EQ(ask(port, "GET", "/v2/health/live").status, 200);
      EXPECT_NE(ask(port, "GET", "/metrics").body.find("\ntrivet_library_changed 1\n"),
                std::string::npos);
    };
    overwrite(bytes_);
    expect_refused();
    EXPECT_EQ(ask(port, "POST", "/v1/library/reload").status, 200);
    EXPECT_EQ(ask(port, "GET", "/v2/health/ready").status, 200);
    EXPECT_NE(ask(port, "GET", "/metrics").body.find("\ntrivet_library_changed 0\n"),
              std::string::npos);
    EXPECT_EQ(detections(ask(port, "POST", query_, scan_)), detections(before));

    // The file is truncated: the bytes beyond its end can no longer be read.
    overwrite(std::string_view(bytes_).substr(0, 5000));
    expect_refused();
    EXPECT_NE(ask(port, "POST", "/v1/library/reload").status, 200);
    expect_refused();
    // A complete file is written under another name, then renamed.
    std::ofstream(folder_ / "new.h5", std::ios::binary) << bytes_;
    fs::rename(folder_ / "new.h5", library_);
    EXPECT_EQ(ask(port, "POST", "/v1/library/reload").status, 200);
    EXPECT_EQ(detections(ask(port, "POST", query_, scan_)), detections(before));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(ChangedLibrary, IsNoFaultOfTheClientWhereItIsDamaged) {
  std::size_t at = 0;
  {
    const auto library = open_library(library_);
    ASSERT_TRUE(library);
    const std::span<const float> column = (*library->samples(0))->samples.x;
    const auto bytes = std::as_bytes(column);
    at = bytes_.find(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    ASSERT_NE(at, std::string::npos);
  }
  bytes_[at] = static_cast<char>(bytes_[at] ^ 1);
  overwrite(bytes_);
  const Outcome outcome = serve({}, [&](int port) {
    const Answer refused = ask(port, "POST", query_, scan_);
    EXPECT_EQ(refused.status, 503) << refused.body;
    EXPECT_NE(refused.body.find("samples"), std::string::npos) << refused.body;
    EXPECT_NE(refused.body.find("checksum"), std::string::npos) << refused.body;
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

TEST_F(ChangedLibrary, IsLoggedWithoutARequest) {
  const Outcome outcome = serve({}, [&](int port) {
    ASSERT_EQ(ask(port, "GET", "/v2/health/ready").status, 200);
    overwrite(bytes_);
    std::this_thread::sleep_for(std::chrono::milliseconds(2500));
  });
  const std::size_t position = outcome.error.find("\"library changed\"");
  EXPECT_NE(position, std::string::npos) << outcome.error;
  EXPECT_EQ(outcome.error.find("\"library changed\"", position + 1), std::string::npos) << "once";
}

TEST_F(ChangedLibrary, GivesNoWrongAnswerAndEndsNothingWhileItIsWrittenUnderLoad) {
  const Outcome outcome = serve({}, [&](int port) {
    const nlohmann::json right = detections(ask(port, "POST", query_, scan_));
    ASSERT_FALSE(right.empty());
    std::atomic<bool> is_finished{false};
    std::atomic<int> num_right{0}, num_refused{0};
    std::thread client([&] {
      while (!is_finished) {
        const Answer answer = ask(port, "POST", query_, scan_);
        if (answer.status == 200) {
          EXPECT_EQ(detections(answer), right);
          ++num_right;
        } else {
          EXPECT_EQ(answer.status, 503) << answer.body;
          ++num_refused;
        }
      }
    });
    for (std::size_t i = 0; i < 12; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(15 * (i % 4)));
      switch (i % 3) {
        case 0:
          overwrite(bytes_);
          break;
        case 1:
          fs::resize_file(library_, bytes_.size() * (i + 1) / 14);
          break;
        default: {
          std::fstream file(library_, std::ios::in | std::ios::out | std::ios::binary);
          file.seekp(static_cast<std::streamoff>(bytes_.size() / 5));
          file << std::string(bytes_.size() / 2, static_cast<char>(37 * i));
        }
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      EXPECT_EQ(ask(port, "GET", "/v2/health/live").status, 200);
      overwrite(bytes_);
      EXPECT_EQ(ask(port, "POST", "/v1/library/reload").status, 200);
    }
    for (const int before = num_right; num_right < before + 2;)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    is_finished = true;
    client.join();
    EXPECT_GT(num_refused, 0);
  });
  EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
}

}  // namespace
}  // namespace trivet::test
