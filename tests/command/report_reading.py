# Takes a page of 'jointplay report' apart, and runs claims about such pages as tests.
import base64, hashlib, html.parser, itertools, json, math, re, struct, sys, tempfile, zlib

NONE = 65535


class Page(html.parser.HTMLParser):
    """The parts of a page, as a browser takes it apart."""

    def __init__(self, text):
        super().__init__()
        self.tags, self.open, self.texts, self.attributes = [], [], {}, []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        self.attributes += [(tag, name, value) for name, value in attributes]
        self.open.append(tag)

    def handle_endtag(self, tag):
        while self.open and self.open.pop() != tag:
            pass

    def handle_data(self, data):
        # a span is a part of the words around it
        around = [tag for tag in self.open if tag != "span"]
        if around:
            self.texts.setdefault(around[-1], []).append(data)

    def text(self, tag):
        return "".join(self.texts.get(tag, []))


def policy(page):
    contents = [value for _, name, value in page.attributes if name == "content"]
    found = [value for value in contents if "default-src" in value]
    assert len(found) == 1, found
    return found[0]


def unpack(page):
    whole = zlib.decompress(base64.b64decode(re.sub(r"\s", "", page.text("template"))))
    (length,) = struct.unpack("<I", whole[:4])
    data = json.loads(whole[4 : 4 + length])
    signals = whole[4 + length :]
    for one in data["runs"]:
        marked = [signal for joint in one["marks"] for signal in joint["signals"]]
        for signal in one["signals"] + marked:
            at, count = signal["offset"], signal["count"]
            low, high = signals[at : at + count], signals[at + count : at + 2 * count]
            codes = itertools.accumulate(low[i] + 256 * high[i] for i in range(count))
            signal["values"] = [
                math.nan if code % 65536 == NONE
                else signal["low"] + signal["slope"] * i + signal["step"] * (code % 65536)
                for i, code in enumerate(codes)]
    return data


def check_policy(page):
    """The policy allows no more than the one script and the one style sheet of the page."""
    rules = policy(page)
    assert rules.startswith("default-src 'none'; "), rules
    assert "unsafe" not in rules
    for tag in ["script", "style"]:
        assert page.tags.count(tag) == 1, tag
        digest = base64.b64encode(hashlib.sha256(page.text(tag).encode()).digest()).decode()
        assert f"{tag}-src 'sha256-{digest}'" in rules, (tag, rules)


def check_requests(text):
    """Nothing in the page asks another place, and nothing but its script does anything."""
    assert not re.search(r"https?:|//[a-z0-9.-]+\.[a-z]{2,}/", text, re.IGNORECASE)
    page = Page(text)
    words = ("src", "href", "action", "data", "style")
    asking = [one for one in page.attributes if one[1] in words]
    assert asking == [], asking
    assert [one for one in page.attributes if one[1].startswith("on")] == []


def check_claims(claims):
    """Runs each claim in one folder, and prints TAP."""
    print(f"1..{len(claims)}")
    with tempfile.TemporaryDirectory() as folder:
        for number, claim in enumerate(claims, 1):
            try:
                claim(folder)
                print(f"ok {number} - {claim.__name__}")
            except AssertionError as error:
                print(f"not ok {number} - {claim.__name__}")
                print("# " + str(error)[:800].replace("\n", "\n# "))
            sys.stdout.flush()
