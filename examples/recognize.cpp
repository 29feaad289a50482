// Recognize a scan and print what was found, as any C++ program can: Boost.Beast and nlohmann-json.
//
// g++ -std=c++20 recognize.cpp -o recognize
// usage: recognize HOST PORT SCAN PARAMETERS       as: recognize 127.0.0.1 8080 scan.ply format=ply
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

namespace beast = boost::beast;
namespace http = beast::http;
using tcp = boost::asio::ip::tcp;

constexpr std::chrono::seconds kDeadline{30};

// One request on a connection of its own. Throws boost::system::system_error.
http::response<http::string_body> post(const std::string& host, const std::string& port,
                                       const std::string& target, const std::string& body) {
  boost::asio::io_context context;
  tcp::resolver resolver(context);
  beast::tcp_stream stream(context);
  stream.expires_after(kDeadline);
  stream.connect(resolver.resolve(host, port));
  http::request<http::string_body> request(http::verb::post, target, 11);
  request.set(http::field::host, host);
  request.set("X-Deadline-Ms", std::to_string(1000 * kDeadline.count()));
  request.body() = body;
  request.prepare_payload();
  http::write(stream, request);
  beast::flat_buffer buffer;
  http::response<http::string_body> response;
  http::read(stream, buffer, response);
  return response;
}

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: recognize HOST PORT SCAN PARAMETERS\n";
    return 2;
  }
  std::ifstream file(argv[3], std::ios::binary);
  const std::string scan(std::istreambuf_iterator<char>(file), {});
  const auto end = std::chrono::steady_clock::now() + kDeadline;
  try {
    http::response<http::string_body> response;
    do {
      response = post(argv[1], argv[2], std::string("/v1/recognize?") + argv[4], scan);
      if (response.result_int() != 503) break;
      std::this_thread::sleep_for(std::chrono::seconds(1));  // as many wait as may: Retry-After
    } while (std::chrono::steady_clock::now() < end);
    const nlohmann::json answer = nlohmann::json::parse(response.body());
    if (response.result_int() != 200) {
      std::cerr << "error: " << response.result_int() << ": " << answer["error"].get<std::string>()
                << "\n";
      return 1;
    }
    for (const nlohmann::json& found : answer["scenes"][0]["detections"]) {
      const nlohmann::json& pose = found["T_scene_model"];
      std::printf("%-20s %6.3f %10.4f %10.4f %10.4f\n", found["model"].get<std::string>().c_str(),
                  found["score"].get<double>(), pose[0][3].get<double>(), pose[1][3].get<double>(),
                  pose[2][3].get<double>());
    }
  } catch (const std::exception& error) {
    std::cerr << "error: " << error.what() << "\n";
    return 1;
  }
}
