# The KC705 board: where every pin of kc705_top is, and the clocks that come from outside. Written by hand from the board's public files;
# lines that follow from the design are in crossings.xdc, those of the DRAM in the files that MIG makes from mig.prj.

set_property CFGBVS VCCO [current_design]
set_property CONFIG_VOLTAGE 2.5 [current_design]

# Clocks: 200 MHz on the board; @screen_mhz@ MHz from the HDMI receiver.
create_clock -name sysclk -period 5.000 [get_ports sysclk_p]
create_clock -name hdmi_rx -period @screen_period@ [get_ports hdmi_rx_clk]

set_property -dict {PACKAGE_PIN AD12 IOSTANDARD DIFF_SSTL15} [get_ports sysclk_p]
set_property -dict {PACKAGE_PIN AD11 IOSTANDARD DIFF_SSTL15} [get_ports sysclk_n]

# The impedance of the DRAM's banks 32 and 34 is that of bank 33, which alone has resistors (UG810).
set_property DCI_CASCADE {32 34} [get_iobanks 33]

# Reset button, LEDs, fan.
set_property -dict {PACKAGE_PIN AB7 IOSTANDARD LVCMOS15} [get_ports cpu_reset]
set_property -dict {PACKAGE_PIN AB8 IOSTANDARD LVCMOS15} [get_ports {leds[0]}]
set_property -dict {PACKAGE_PIN AA8 IOSTANDARD LVCMOS15} [get_ports {leds[1]}]
set_property -dict {PACKAGE_PIN AC9 IOSTANDARD LVCMOS15} [get_ports {leds[2]}]
set_property -dict {PACKAGE_PIN AB9 IOSTANDARD LVCMOS15} [get_ports {leds[3]}]
set_property -dict {PACKAGE_PIN AE26 IOSTANDARD LVCMOS25} [get_ports {leds[4]}]
set_property -dict {PACKAGE_PIN G19 IOSTANDARD LVCMOS25} [get_ports {leds[5]}]
set_property -dict {PACKAGE_PIN E18 IOSTANDARD LVCMOS25} [get_ports {leds[6]}]
set_property -dict {PACKAGE_PIN F16 IOSTANDARD LVCMOS25} [get_ports {leds[7]}]
set_property -dict {PACKAGE_PIN L26 IOSTANDARD LVCMOS25} [get_ports fan_pwm]

# USB-UART (CP2103).
set_property -dict {PACKAGE_PIN M19 IOSTANDARD LVCMOS25} [get_ports uart_rx]
set_property -dict {PACKAGE_PIN K24 IOSTANDARD LVCMOS25} [get_ports uart_tx]

# I2C of the board: PCA9548A, behind it the ADV7511.
set_property -dict {PACKAGE_PIN K21 IOSTANDARD LVCMOS25 PULLUP TRUE} [get_ports iic_scl]
set_property -dict {PACKAGE_PIN L21 IOSTANDARD LVCMOS25 PULLUP TRUE} [get_ports iic_sda]
set_property -dict {PACKAGE_PIN P23 IOSTANDARD LVCMOS25} [get_ports iic_mux_reset_n]

# HDMI out: ADV7511.
set_property -dict {PACKAGE_PIN K18 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports hdmi_tx_clk]
set_property -dict {PACKAGE_PIN J18 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports hdmi_tx_hsync]
set_property -dict {PACKAGE_PIN H20 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports hdmi_tx_vsync]
set_property -dict {PACKAGE_PIN H17 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports hdmi_tx_de]
set_property -dict {PACKAGE_PIN B23 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[0]}]
set_property -dict {PACKAGE_PIN A23 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[1]}]
set_property -dict {PACKAGE_PIN E23 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[2]}]
set_property -dict {PACKAGE_PIN D23 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[3]}]
set_property -dict {PACKAGE_PIN F25 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[4]}]
set_property -dict {PACKAGE_PIN E25 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[5]}]
set_property -dict {PACKAGE_PIN E24 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[6]}]
set_property -dict {PACKAGE_PIN D24 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[7]}]
set_property -dict {PACKAGE_PIN F26 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[8]}]
set_property -dict {PACKAGE_PIN E26 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[9]}]
set_property -dict {PACKAGE_PIN G23 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[10]}]
set_property -dict {PACKAGE_PIN G24 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[11]}]
set_property -dict {PACKAGE_PIN J19 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[12]}]
set_property -dict {PACKAGE_PIN H19 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[13]}]
set_property -dict {PACKAGE_PIN L17 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[14]}]
set_property -dict {PACKAGE_PIN L18 IOSTANDARD LVCMOS25 SLEW FAST} [get_ports {hdmi_tx_data[15]}]

# HDMI in: ADV7611 on an FMC-IMAGEON card in the LPC connector (J2), and its I2C. VADJ is 2.5 V.
set_property -dict {PACKAGE_PIN AG29 IOSTANDARD LVCMOS25} [get_ports hdmi_rx_clk]
set_property -dict {PACKAGE_PIN AF30 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[0]}]
set_property -dict {PACKAGE_PIN AE30 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[1]}]
set_property -dict {PACKAGE_PIN AF28 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[2]}]
set_property -dict {PACKAGE_PIN AJ29 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[3]}]
set_property -dict {PACKAGE_PIN AK30 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[4]}]
set_property -dict {PACKAGE_PIN AE28 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[5]}]
set_property -dict {PACKAGE_PIN AJ28 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[6]}]
set_property -dict {PACKAGE_PIN AK29 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[7]}]
set_property -dict {PACKAGE_PIN AA30 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[8]}]
set_property -dict {PACKAGE_PIN Y30 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[9]}]
set_property -dict {PACKAGE_PIN AC30 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[10]}]
set_property -dict {PACKAGE_PIN AC29 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[11]}]
set_property -dict {PACKAGE_PIN AB30 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[12]}]
set_property -dict {PACKAGE_PIN AB29 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[13]}]
set_property -dict {PACKAGE_PIN AE29 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[14]}]
set_property -dict {PACKAGE_PIN AD29 IOSTANDARD LVCMOS25} [get_ports {hdmi_rx_data[15]}]
set_property -dict {PACKAGE_PIN AC22 IOSTANDARD LVCMOS25 PULLUP TRUE} [get_ports fmc_iic_scl]
set_property -dict {PACKAGE_PIN AD22 IOSTANDARD LVCMOS25 PULLUP TRUE} [get_ports fmc_iic_sda]
set_property -dict {PACKAGE_PIN AF23 IOSTANDARD LVCMOS25} [get_ports fmc_iic_reset_n]

# The receiver's data go through the pads' zero-hold delay into registers there. Their phase is the receiver's: 'edof board align' sets it,
# and these delays are those of an aligned receiver (docs/hardware.md has the budget). The transmitter gets its clock inverted by an ODDR.
set_property IOBDELAY IFD [get_ports {hdmi_rx_data[*]}]
set_input_delay -clock hdmi_rx -max @input_delay_max@ [get_ports {hdmi_rx_data[*]}]
set_input_delay -clock hdmi_rx -min @input_delay_min@ [get_ports {hdmi_rx_data[*]}]
create_generated_clock -name hdmi_tx -source [get_pins screen_clock_out/C] -divide_by 1 -invert [get_ports hdmi_tx_clk]
set_output_delay -clock hdmi_tx -max 1.800 [get_ports {hdmi_tx_data[*] hdmi_tx_hsync hdmi_tx_vsync hdmi_tx_de}]
set_output_delay -clock hdmi_tx -min -1.300 [get_ports {hdmi_tx_data[*] hdmi_tx_hsync hdmi_tx_vsync hdmi_tx_de}]

# Slow lines that are synchronised inside or looked at by people.
set_false_path -from [get_ports {cpu_reset uart_rx iic_scl iic_sda fmc_iic_scl fmc_iic_sda}]
set_false_path -to [get_ports {uart_tx iic_scl iic_sda iic_mux_reset_n fmc_iic_scl fmc_iic_sda fmc_iic_reset_n leds[*] fan_pwm}]
