#include "apps/report/html.hpp"

#include <fmt/format.h>

#include "storage/common/valid_text.hpp"

namespace trivet::apps {
namespace {

/// Colors follow the reader's light or dark setting; on a phone the pictures of a scene are
/// stacked.
constexpr std::string_view kStyle = R"css(
:root{color-scheme:light dark;--page:#f6f7f9;--card:#fff;--link:#2f62bd;--text:#1b1f26;--dim:#626b79;--line:#dfe3e9;--bar:#4477d0;--range:#4477d040;
--right:#16803f;--wrong:#c92a2a;--missed:#1f66c7;--neutral:#6b7380;--doubtful:#946200;--ppf:#3b6fd1;--trisi:#c9700c;--fused:#14866d}
@media(prefers-color-scheme:dark){:root{--page:#111318;--card:#1a1d24;--link:#6f9df0;--text:#e7eaf0;--dim:#98a1b0;--line:#2c313b;--bar:#6f9df0;
--range:#6f9df040;--right:#3ecf7f;--wrong:#ff6b6b;--missed:#5aa6ff;--neutral:#9aa3b0;--doubtful:#f2b83b;--ppf:#7aa7f7;--trisi:#f0a04b;--fused:#46c9a8}}
*{box-sizing:border-box}
body{margin:0 auto;padding:20px 16px 48px;max-width:1360px;background:var(--page);color:var(--text);
font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif;font-variant-numeric:tabular-nums}
h1{font-size:1.5rem;margin:0}h2{font-size:1.1rem;margin:32px 0 10px}p{margin:4px 0}.dim{color:var(--dim)}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(165px,1fr));gap:12px;margin:18px 0}
.card,figure,.table{background:var(--card);border:1px solid var(--line);border-radius:10px}
.card{padding:12px 16px}.card b{display:block;font-size:1.7rem;line-height:1.25;font-weight:650}
.tables{columns:2 400px;column-gap:16px}.tables>div{break-inside:avoid;padding-top:24px}.tables h2{margin:0 0 10px}
.table{overflow-x:auto;padding:2px 14px 6px}table{border-collapse:collapse;width:100%}
th{font-weight:500;color:var(--dim);text-align:left;font-size:.85rem}th,td{padding:5px 8px 5px 0;border-bottom:1px solid var(--line);white-space:nowrap}
td:first-child{white-space:normal;overflow-wrap:anywhere;min-width:9.5em}tr:last-child td{border-bottom:0}.n{text-align:right}
.bar{position:relative;display:block;min-width:64px;height:10px;border-radius:5px;background:var(--line)}
.bar i{position:absolute;top:0;bottom:0;left:0;border-radius:5px;background:var(--bar)}
.bar u{position:absolute;top:-3px;bottom:-3px;border:solid var(--dim);border-width:0 2px}
.bar u::after{content:"";position:absolute;left:0;right:0;top:7px;border-top:2px solid var(--dim)}
.key{display:flex;flex-wrap:wrap;gap:6px 18px;font-size:.9rem;margin:0 0 12px}.key span{display:inline-flex;align-items:center;gap:6px}
.swatch{display:inline-block;width:13px;height:13px;border-radius:3px;flex:none}.label{display:inline-flex;align-items:center;gap:6px}.ring{background:none!important;border:3px solid}
figure{margin:0 0 18px;padding:12px}figcaption{display:flex;flex-wrap:wrap;gap:2px 16px;align-items:baseline;margin:0 2px 10px}
figcaption b{font-size:1.02rem}
.pair{display:grid;grid-template-columns:var(--left,1fr) 1fr;gap:10px;align-items:start}.view{position:relative;overflow:hidden;border-radius:6px;container-type:inline-size}
.view img{display:block;width:100%;height:auto}
.tag{position:absolute;transform:translate(-50%,-50%);padding:1px 6px;border-radius:4px;background:#0d1016d9;color:#fff;font-size:max(9px,min(12px,2.1cqw));
line-height:1.35;white-space:nowrap;border-bottom:2px solid;pointer-events:none}
.right{color:var(--right)}.wrong{color:var(--wrong)}.missed{color:var(--missed)}.neutral{color:var(--neutral)}
.doubtful{color:var(--doubtful)}
.headline{font-size:1.15rem;max-width:62rem;margin:14px 0}
.gallery{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,300px),1fr));gap:16px}.exhibit{margin:0}
.exhibit p{margin:6px 2px 0;font-size:.9rem}
.chart{display:block;width:100%;max-width:460px;height:auto;margin:8px auto 0}
.chart text{font-size:12px;fill:var(--dim)}.chart .name{font-size:13px;fill:var(--text)}.chart .number{font-size:10.5px;fill:var(--text)}
.chart .mid{text-anchor:middle}.chart .end{text-anchor:end}.chart .grid{stroke:var(--line);fill:none}
.chart .curve{stroke:var(--bar);stroke-width:2.2;fill:none;stroke-linejoin:round}.chart .ideal{stroke:var(--dim);stroke-dasharray:5 4;fill:none}
.chart .range{stroke:var(--bar);stroke-width:1.6;opacity:.55}.chart .share{fill:var(--bar)}
.chart .best{fill:var(--card);stroke:var(--doubtful);stroke-width:2.5}.chart .reported{fill:var(--right)}
.dot{width:11px;height:11px;border-radius:50%;flex:none}.dot.best{border:2.5px solid var(--doubtful)}.dot.reported{background:var(--right)}
p.key{margin:6px 4px 8px;color:var(--dim)}
.chart .line{fill:none;stroke-width:2;stroke-linejoin:round}.chart .whisker{stroke-width:1.6;opacity:.6}
.chart g.ppf{stroke:var(--ppf)}.chart g.trisi{stroke:var(--trisi)}.chart g.fused{stroke:var(--fused)}
circle.ppf{fill:var(--ppf)}circle.trisi{fill:var(--trisi)}circle.fused{fill:var(--fused)}
.dot.ppf{background:var(--ppf)}.dot.trisi{background:var(--trisi)}.dot.fused{background:var(--fused)}
.findings{max-width:74rem;padding-left:1.3em;margin:10px 0}.findings li{margin:7px 0}.about{max-width:62rem}
.charts{display:grid;grid-template-columns:repeat(2,minmax(0,1fr));gap:12px}.charts .chart{max-width:none}.charts h4{margin:8px 2px 0;font-size:.95rem;font-weight:600}
.panel{margin-bottom:20px}.panel>h3{font-size:1rem;margin:18px 0 8px}.panel>.table{margin-top:12px}.usual td{background:var(--range)}.usual .dim{color:var(--text)}
figure h2{font-size:1rem;margin:16px 2px 4px;font-weight:600}.wrap{overflow-x:auto}.words{white-space:normal;min-width:15em;overflow-wrap:anywhere}
figure td:first-child{min-width:0}figure td.id{min-width:2.2em;width:2.2em;white-space:nowrap;color:var(--dim)}.table+figure{margin-top:18px}
.scene{display:grid;grid-template-columns:minmax(0,1fr) minmax(0,1fr);gap:0 18px;align-items:start}.scene h2:first-child{margin-top:0}
.views{align-self:stretch;display:grid;gap:10px;align-content:start}.views>:only-child{position:sticky;top:8px}.found .head td{border-bottom:0;padding-bottom:0}.found tr:not(.head) td{padding-top:0}
.layers{display:flex;flex-wrap:wrap}.layers>input{position:absolute;opacity:0}.layers>label{padding:3px 12px;border:1px solid var(--line);border-bottom:0;
border-radius:6px 6px 0 0;color:var(--dim);font-size:.9rem;cursor:pointer}.layers>:checked+label{color:var(--text);font-weight:600;background:var(--page)}
.layers>:focus-visible+label{outline:2px solid var(--bar)}.layers>.view{flex:0 0 100%;display:none;border-top-left-radius:0}
.layers>:nth-of-type(1):checked~.view:nth-of-type(1),.layers>:nth-of-type(2):checked~.view:nth-of-type(2),.layers>:nth-of-type(3):checked~.view:nth-of-type(3){display:block}
.parts td{vertical-align:top}.part{display:block;height:8px;border-radius:4px;background:var(--line);overflow:hidden;margin-top:6px;min-width:8px}
.part i{display:block;height:100%;background:var(--bar)}.parts .dim{font-size:.75rem}
pre{white-space:pre-wrap;overflow-wrap:anywhere;margin:8px 0;font-size:.85rem}a{color:var(--link)}
details{margin:10px 2px 0}summary{cursor:pointer;color:var(--dim);font-size:.9rem}details div{overflow-x:auto}
@media(max-width:760px){.pair,.scene,.charts{grid-template-columns:minmax(0,1fr)}.views>:only-child{position:static}.scene h2:first-child{margin-top:14px}.exhibit .pair{grid-template-columns:1fr 1fr}body{padding:14px 10px 32px}figure{padding:8px}
.table{padding:2px 10px 6px}th,td{padding-right:6px}.bar{min-width:44px}}
@media(max-width:520px){.charts .chart :is(text,.name){font-size:14.5px}td:first-child{min-width:7.4em}.tally :is(td,th):is(:nth-child(4),:nth-child(7),:nth-child(8)){display:none}table{font-size:.87rem}.study :is(td,th):is(:nth-child(2),:nth-child(4)){display:none}.headline{font-size:1.05rem}.words{min-width:10.5em}
.parts :is(td,th):is(:nth-child(2),:nth-child(3)){display:none}.found :is(.head>td,th):nth-child(5){display:none}.found .words{min-width:0}.parts th{writing-mode:vertical-rl;padding:0 0 4px}.parts th span{display:none}.parts td:not(.id){padding-right:3px}.parts .dim{font-size:.68rem}}
@media print{html{font-size:11px}body{max-width:none;padding:0;font-size:1rem;background:none}
.tables{columns:auto;display:grid;grid-template-columns:1fr 1fr;gap:0 12px;align-items:start}.tables>.wide{grid-column:1/-1}.table{overflow:visible}
.cards{grid-template-columns:repeat(6,1fr);gap:6px}.card{padding:6px 8px}.gallery,.scene{grid-template-columns:1fr 1fr}.views>:only-child{position:static}.layers>label{display:none}.pair{grid-template-columns:var(--left,1fr) 1fr}.wrap{overflow:visible}.key{break-after:avoid}
figure,.card,.table,.chart,.charts,.pair,.layers,tr{break-inside:avoid}.charts{grid-template-columns:1fr 1fr}.study.table{break-inside:auto}figure.long{break-inside:auto}h2,h3,figcaption{break-after:avoid}.bar,.bar i,.part,.part i,.swatch,.tag,.dot,.usual td{print-color-adjust:exact;-webkit-print-color-adjust:exact}}
)css";

}  // namespace

std::string html_page(std::string_view title, std::string_view content) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" "
      "content=\"width=device-width,initial-scale=1\">\n<title>{}</title>\n<style>{}</style>\n"
      "</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
      escape_html(title), kStyle, content);
}

std::string escape_html(std::string_view bytes) {
  const std::string text = printable_lines(bytes);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string percent(double share) { return fmt::format("{:.1f} %", 100 * share); }

std::string card(std::string_view title, std::string_view value, std::string_view note) {
  return fmt::format(
      "<div class=\"card\"><span class=\"dim\">{}</span><b>{}</b><span "
      "class=\"dim\">{}</span></div>\n",
      title, value, note);
}

std::string png_address(std::span<const std::byte> png) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out = "data:image/png;base64,";
  out.reserve(out.size() + (png.size() + 2) / 3 * 4);
  // RFC 4648, section 4: three bytes become four digits of six bits, the last ones padded with '='.
  for (std::size_t i = 0; i < png.size(); i += 3) {
    unsigned bits = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      bits = bits << 8 | (i + k < png.size() ? std::to_integer<unsigned>(png[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      out += i + k <= png.size() ? kDigits[bits >> (18 - 6 * k) & 63U] : '=';
    }
  }
  return out;
}

}  // namespace trivet::apps
