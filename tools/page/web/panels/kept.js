// Settings that the visitor keeps: a strip of small pictures under the picture, each of which brings
// its settings back. So more than two can be compared.

import { announce, by_id, element } from "../dom.js";

const kMost = 6;
const kHeight = 60;  // of a small picture, in pixels

/** `link()` is that of the state now, `words()` two lines that name it, `open(link)` brings one back. */
export function start_kept({ link, words, canvas, open }) {
  const list = by_id("kept");
  const kept = [];  // {link, words, picture}, the oldest first

  function small_picture() {
    const from = canvas();
    const picture = element("canvas", { "aria-hidden": "true" });
    picture.height = kHeight;
    picture.width = Math.round(kHeight * from.width / from.height);
    picture.getContext("2d").drawImage(from, 0, 0, picture.width, picture.height);
    return picture;
  }

  function show() {
    document.documentElement.toggleAttribute("data-kept", kept.length > 0);
    list.hidden = kept.length === 0;
    list.replaceChildren(...kept.map((one) => {
      const press = element("button", { type: "button", title: one.words.join(", ") }, one.picture,
                            ...one.words.map((line) => element("span", {}, line)));
      press.addEventListener("click", () => open(one.link));
      const away = element("button", { type: "button", class: "away", "aria-label": `Forget ${one.words.join(", ")}` }, "×");
      away.addEventListener("click", () => {
        kept.splice(kept.indexOf(one), 1);
        show();
        by_id("keep-settings").focus();
      });
      return element("li", {}, press, away);
    }));
  }

  by_id("keep-settings").addEventListener("click", () => {
    kept.push({ link: link(), words: words(), picture: small_picture() });
    if (kept.length > kMost) kept.shift();
    show();
    announce("These settings are kept under the picture.");
  });
}
