// What the page tells the page around it, where one shows it in a frame, and what that may ask. Alone it tells nobody.

class Frame {
  /** `heard` has a function for each kind of message. Neither page can name the origin of the other: each looks who sends. */
  constructor(heard) {
    this.around = window.parent === window ? null : window.parent;
    this.look = null;
    if (!this.around) return;
    document.body.dataset.framed = "";
    this.listenToDrags();
    window.addEventListener("message", (event) => {
      const message = event.source === this.around ? event.data?.geoAdapt : null;
      if (message && Object.hasOwn(heard, message.kind)) heard[message.kind](message);
    });
  }

  /** Files that are dropped are for the page around: it takes them once it knows that something is dragged. */
  listenToDrags() {
    for (const kind of ["dragover", "drop"]) {
      document.addEventListener(kind, (event) => {
        event.preventDefault();
        this.tell("dragging", {});
      });
    }
  }

  tell(kind, content) {
    this.around?.postMessage({ geoAdapt: { kind, ...content } }, "*");
  }

  /** Tells how the page looks, where that has changed. The first look is not news. */
  drawn(look) {
    if (!this.around) return;
    const text = JSON.stringify(look);
    if (this.look === null) this.tell("ready", {});
    else if (this.look !== text) this.tell("look", look);
    this.look = text;
  }

  /** What the page around has asked for is not told back. */
  followed(look) {
    this.look = JSON.stringify(look);
  }
}
