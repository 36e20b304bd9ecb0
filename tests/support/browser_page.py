"""Functions that the tests of a page in a browser share."""

import time

from selenium import webdriver


class BrowserPage:
    """Base of a unittest.TestCase with a selenium driver as `browser`."""

    browser = None
    patience_s = 30  # of wait_until

    def run_script(self, script):
        return self.browser.execute_script(script)

    def wait_until(self, script):
        """Waits until the script returns a true value; fails after `patience_s`."""
        deadline = time.monotonic() + self.patience_s
        while not self.run_script(script):
            self.assertLess(time.monotonic(), deadline, f"waited in vain for: {script}\n{self.browser.get_log('browser')}")
            time.sleep(0.05)

    def press(self, *keys):
        webdriver.ActionChains(self.browser).send_keys(*keys).perform()
