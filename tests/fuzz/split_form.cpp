// A multipart body: the content type on the first line, then the body.
#include "apps/service/http/multipart.hpp"
#include "fuzz/targets.hpp"

namespace trivet::fuzz {

void split_form(std::string_view input) {
  const std::size_t line = std::min(input.find('\n'), input.size());
  const std::string_view content_type = input.substr(0, line);
  const std::string_view body = input.substr(std::min(line + 1, input.size()));
  if (!apps::service::is_form(content_type)) return;
  const Result<std::vector<apps::service::FormPart>> parts =
      apps::service::split_form(content_type, body);
  if (!parts) return require(parts.error().code == ErrorCode::bad_data, "faults are the client's");
  const char* last = body.data();
  for (const apps::service::FormPart& part : *parts) {
    require(part.content.data() >= last &&
                part.content.data() + part.content.size() <= body.data() + body.size(),
            "parts lie in the body, one behind the other");
    last = part.content.data() + part.content.size();
  }
}

std::vector<std::string> split_form_seeds() {
  const std::string part = "--e\r\nContent-Disposition: form-data; name=\"scene\"; filename=a.ply";
  return {"multipart/form-data; boundary=e\n" + part +
              "\r\nContent-Type: model/ply\r\n\r\nply\r\n" +
              "--e\r\ncontent-disposition: form-data; name=options\r\n\r\n{}\r\n--e--\r\n",
          "Multipart/Form-Data; charset=utf-8; boundary=\"e\"\nbefore\r\n" + part +
              "\r\n\r\n\r\n--e-- after",
          "multipart/form-data\n"};
}

}  // namespace trivet::fuzz
