"""Debian's Chromium without a screen, which films and tests drive; ImportError names what is missing."""
import shutil

from selenium import webdriver
from selenium.common.exceptions import WebDriverException  # noqa: F401 - of whom this starts it
from selenium.webdriver.chrome.service import Service

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
for found, package in ((CHROMIUM, "chromium"), (DRIVER, "chromium-driver")):
    if not found:
        raise ImportError(f"no {package}", name=package)


class Refused(Exception):
    """What the page says was wrong."""


def start(width, height, own_session=False):
    """A browser whose window has this size; with `own_session` Ctrl-C does not reach it."""
    options = webdriver.ChromeOptions()
    options.binary_location = CHROMIUM
    for argument in ("--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--hide-scrollbars",
                     "--enable-unsafe-swiftshader", f"--window-size={width},{height}"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    service = Service(DRIVER, popen_kw={"start_new_session": own_session})
    driver = webdriver.Chrome(service=service, options=options)
    driver.set_script_timeout(600)  # a crowd without a graphics card, beside other work
    return driver


def ask(driver, body, *values):
    """What the body of an asynchronous function returns, in the page; raises Refused. On a busy machine a page is
    there before its modules have run."""
    answer = driver.execute_async_script(
        "const done = arguments[arguments.length - 1], values = [...arguments].slice(0, -1);"
        "const soon = () => new Promise((go) => setTimeout(go, 100));"
        "(async () => { while (document.getElementById('wasm') && !globalThis.shapebench) await soon();"
        f"{body} }})().then((value) => done({{ value }}), "
        "(error) => done({ error: String(error.stack || error) }))", *values)
    if "error" in answer:
        raise Refused(answer["error"])
    return answer.get("value")
