// The response of a service that was built without the page.
#include "apps/service/serve/routes/page.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace trivet::apps::service {
namespace {

TEST(NoPage, AnswersBrowsersWithAPage) {
  HttpRequest request;
  request.headers = {{"accept", "text/html,application/xhtml+xml,*/*;q=0.8"}};
  const HttpResponse response = no_page_response(request);
  EXPECT_EQ(response.status, 404U);
  EXPECT_EQ(response.content_type, "text/html; charset=utf-8");
  EXPECT_NE(response.body.find("scripts/build-web"), std::string::npos);
}

TEST(NoPage, AnswersProgramsWithJson) {
  HttpRequest request;
  request.headers = {{"accept", "*/*"}};
  const HttpResponse response = no_page_response(request);
  EXPECT_EQ(response.status, 404U);
  EXPECT_NE(nlohmann::json::parse(response.body)["error"].get<std::string>().find("build-web"),
            std::string::npos);
}

}  // namespace
}  // namespace trivet::apps::service
